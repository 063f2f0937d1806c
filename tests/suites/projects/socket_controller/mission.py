def load(link):
    link.send("open")
    link.send("x/120")
    link.send("close")
    answer = link.send("held?")
    link.send("x/0")
    return answer
