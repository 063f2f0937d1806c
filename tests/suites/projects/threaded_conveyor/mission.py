import threading


def both_lines(left, right):
    threads = [threading.Thread(target=feed, args=(line,)) for line in (left, right)]
    for thread in threads:
        thread.start()
        thread.join()
    left.stop()
    right.stop()


def feed(line):
    line.forward(0.5)
    line.forward(0.25)
