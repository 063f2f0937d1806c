class Arm:
    def __init__(self):
        self.z = 0.0
        self.angle = 0
        self.wiggles = 0

    def down(self, mm):
        self.z -= mm

    def force(self):
        return 10.0 if self.z < -5 else 1.0

    def wiggle(self, deg):
        self.angle += deg
        self.wiggles += 1

    def depth(self):
        return self.z
