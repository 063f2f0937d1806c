class Cell:
    def __init__(self):
        self.done = []

    def move(self, x, speed=1.0):
        self.done.append(("move", x))

    def light(self, on):
        self.done.append(("light", on))

    def ready(self):
        return True
