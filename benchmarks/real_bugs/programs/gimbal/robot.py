"""Two motors of a gimbal, in degrees, as plain objects."""


class Motors:
    """Are where they were sent, but for what they slip."""

    def __init__(self, pan=0.0, tilt=0.0, slip=0.0):
        self.pan, self.tilt, self.slip = pan, tilt, slip
        self.moving = False
        self.log = []

    def set_pan(self, degrees):
        self.pan = degrees - self.slip
        self.log.append(("pan", degrees))

    def set_tilt(self, degrees):
        self.tilt = degrees
        self.log.append(("tilt", degrees))

    def read_pan(self):
        return self.pan

    def read_tilt(self):
        return self.tilt

    def is_moving(self):
        return self.moving
