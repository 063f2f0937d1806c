class Doser:
    def __init__(self, viscous=False):
        self.open = False
        self.out = 0.0
        self.at = 0.0
        self.factor = 0.5 if viscous else 1.0

    def valve(self, is_open):
        self.open = is_open

    def plunger(self, mm):
        if self.open:
            self.out += mm * self.factor
        self.at += mm
