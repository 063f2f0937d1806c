class Arm:
    def __init__(self):
        self.z = 0.0
        self.angle = 0.0

    def lift(self, dz):
        self.z = round(self.z + dz, 6)

    def turn(self, angle):
        self.angle += angle
