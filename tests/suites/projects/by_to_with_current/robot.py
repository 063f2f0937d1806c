class Saw:
    def __init__(self):
        self.x = 0.0
        self.angle = 0
        self.farthest = 0.0

    def advance(self, mm):
        self.x += mm
        self.farthest = max(self.farthest, self.x)

    def rotate_to(self, deg):
        self.angle = deg

    def position(self):
        return self.x

    def heading(self):
        return self.angle
