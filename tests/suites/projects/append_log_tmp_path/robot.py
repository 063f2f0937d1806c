class Arm:
    def __init__(self):
        self.x = 0.0

    def move(self, dx):
        self.x += dx

    def park(self):
        self.x = 0.0
