class Arm:
    def __init__(self):
        self.x = 0.0

    def move(self, x):
        self.x += x

    def home(self):
        self.x = 0.0

    def where(self):
        return self.x
