class Arm:
    def __init__(self):
        self.r = 0.4
        self.angle = 0
        self.resting = False

    def out(self, m):
        self.r = round(self.r + m, 6)

    def turn(self, deg):
        self.angle += deg

    def reach(self):
        return self.r

    def rest(self):
        self.resting = True
