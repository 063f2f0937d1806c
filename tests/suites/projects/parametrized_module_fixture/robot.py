class Vise:
    def __init__(self):
        self.gap = 20.0
        self.locked = False

    def open(self):
        self.gap = 100.0
        self.locked = False

    def jaw(self, mm):
        self.gap += mm

    def width(self):
        return self.gap

    def lock(self, on):
        self.locked = on
