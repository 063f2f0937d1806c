class Sprayer:
    def __init__(self):
        self.x = 0.0
        self.painting = False
        self.painted = 0.0

    def valve(self, is_open):
        self.painting = is_open

    def sweep(self, dx):
        if self.painting:
            self.painted += dx
        self.x += dx
