class Arm:
    def __init__(self):
        self.x = 0.0
        self.braked = False

    def move(self, dx):
        self.x = round(self.x + dx, 6)

    def position(self):
        return self.x

    def brake(self, on):
        self.braked = on
