"""An arm with a torch, and a welding source, as plain objects."""


class Arm:
    """Is where it was sent; what it did is kept."""

    def __init__(self):
        self.place = (0.0, 0.0, 0.5)
        self.log = []

    def move_to(self, x, y, z, speed=0.25):
        self.place = (x, y, z)
        self.log.append((x, y, z, speed))


class Source:
    """Burns 0.15 s after it is switched on, if there is gas and a current."""

    def __init__(self, gas=1.0, strikes=True):
        self.pressure, self.strikes = gas, strikes
        self.amperes = 0.0
        self.is_on = False
        self.since = 0.0
        self.log = []

    def set_current(self, amperes):
        self.amperes = amperes
        self.log.append(("current", amperes))

    def on(self):
        self.is_on, self.since = True, 0.0
        self.log.append("on")

    def off(self):
        self.is_on = False
        self.log.append("off")

    def wait(self, seconds):
        self.since += seconds

    def gas(self):
        return self.pressure

    def is_burning(self):
        return self.is_on and self.strikes and self.since >= 0.15 and self.amperes > 0
