class Arm:
    def __init__(self):
        self.x = 0.0
        self.closed = False
        self.log = []

    def move(self, x):
        self.x += x
        self.log.append(x)

    def grip(self, closed):
        self.closed = closed

    def where(self):
        return self.x
