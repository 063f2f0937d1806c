class Arm:
    def __init__(self):
        self.z = 0.0

    def lift(self, dz):
        self.z = round(self.z + dz, 6)
