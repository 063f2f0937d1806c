class Probe:
    """A touch probe over a surface that rises."""

    def __init__(self):
        self.x = 0.0
        self.out = False

    def step(self, dx):
        self.x += dx

    def touch(self):
        self.out = True
        return 0.25 * self.x

    def retract(self):
        self.out = False
