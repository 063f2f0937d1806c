class Arm:
    def __init__(self):
        self.over = None
        self.height = 0.2
        self.held = None
        self.cups = {1: "red", 2: "blue"}

    def above(self, cup):
        self.over = cup

    def down(self, m):
        self.height = round(self.height - m, 3)

    def grasp(self):
        if self.height == 0.0:
            self.held = self.cups.pop(self.over, None)

    def look(self):
        return self.held
