class Cart:
    """A cart that drives, in a simulation."""

    def __init__(self):
        self.x = 0.0
        self.beeps = 0

    def drive(self, distance, speed=1.0):
        if abs(distance) > 5:
            raise ValueError("too far")
        self.x += distance

    def odometer(self):
        return self.x

    def beep(self):
        self.beeps += 1
