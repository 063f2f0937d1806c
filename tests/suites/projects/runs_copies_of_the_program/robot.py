class Arm:
    def __init__(self):
        self.x = 0
        self.turned = 0
        self.done = []

    def lift(self, dz):
        self.x += dz
        self.done.append(("lift", dz))

    def turn(self, angle):
        self.turned += angle
        self.done.append(("turn", angle))
