class Axis:
    def __init__(self):
        self.at = 0.0

    def jog(self, mm):
        self.at += mm

    def read(self):
        return self.at
