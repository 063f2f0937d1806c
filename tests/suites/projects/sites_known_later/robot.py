class Arm:
    def __init__(self):
        self.z, self.closed, self.swings = 0.0, False, 0

    def lower(self, dz):
        self.z -= dz

    def grip(self, closed):
        self.closed = closed

    def height(self):
        return self.z

    def swing(self, angle):
        self.swings += 1
