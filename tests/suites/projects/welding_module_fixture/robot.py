"""A welding torch over a flat plate."""


class OutOfReach(Exception):
    """The torch would leave the plate."""


class Torch:
    def __init__(self):
        self.x = self.y = 0.0
        self.lit = False
        self.seams = []

    def move_to(self, x, y):
        self._go(x, y)

    def move_by(self, dx, dy):
        self._go(self.x + dx, self.y + dy)

    def _go(self, x, y):
        if not (-100 <= x <= 100 and -100 <= y <= 100):
            raise OutOfReach(f"({x}, {y}) is beside the plate")
        if self.lit:
            self.seams.append(((self.x, self.y), (x, y)))
        self.x, self.y = x, y

    def switch(self, on):
        self.lit = on

    def where(self):
        return (self.x, self.y)
