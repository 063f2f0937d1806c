class Axis:
    def __init__(self, at):
        self.at = at
        self.homed = False

    def jog(self, mm):
        self.at = max(self.at + mm, 0)

    def zero(self):
        self.homed = self.at == 0

    def position(self):
        return self.at
