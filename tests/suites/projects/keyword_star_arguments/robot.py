class Arm:
    def __init__(self):
        self.x = self.z = 0.0
        self.sucking = None
        self.history = []

    def line(self, dx, dz=0.0, *, speed=0.1, blend=0.0):
        self.x += dx
        self.z += dz
        self.history.append(speed)

    def vacuum(self, *, on):
        self.sucking = on
