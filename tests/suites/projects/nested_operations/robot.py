class Cell:
    """Its commands are made of smaller ones, which are operations as well."""

    def __init__(self):
        self.x = 0.0
        self.tool = 0
        self.locked = True
        self.shifted = 0.0

    def move(self, dx):
        self.x = round(self.x + dx, 6)

    def lock(self, on):
        self.locked = on

    def park(self):
        self.move(-self.x)
        self.lock(False)
        self.tool = 0

    def fetch(self, slot):
        self.move(0.1 * slot)
        self.tool = round(self.x * 10)
        self.lock(True)
        return self.tool

    def probe_tool(self):
        self.move(0.05)
        return 0.02 * self.tool

    def shift(self, dz):
        self.shifted += dz
