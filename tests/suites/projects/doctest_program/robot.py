class Table:
    """A rotary table."""

    def __init__(self):
        self._angle = 0
        self.turns = 0
        self.braked = False

    def turn(self, degrees):
        self._angle = (self._angle + degrees) % 360
        self.turns += 1

    def angle(self):
        return self._angle

    def brake(self, on):
        self.braked = on
