class Sensor:
    def __init__(self):
        self.angle = 0
        self.lit = True

    def rotate(self, deg):
        self.angle += deg

    def measure(self):
        return 10.0 + self.angle

    def laser(self, on):
        self.lit = on
