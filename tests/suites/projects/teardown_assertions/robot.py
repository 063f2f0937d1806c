class Spindle:
    def __init__(self):
        self.rpm = 0
        self.depth = 0.0
        self.deepest = 0.0

    def speed(self, rpm):
        self.rpm = rpm

    def feed(self, mm):
        self.depth += mm
        self.deepest = max(self.deepest, self.depth)
