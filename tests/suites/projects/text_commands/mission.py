from link import send


def sort_box():
    send("pick")
    send("lift/5.00")
    colour = send("colour?")
    for _ in range(2):
        send(f"turn/{45 if colour == 'red' else -45}")
    send("drop/5.00")
    send("release")
