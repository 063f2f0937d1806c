class Robot:
    def __init__(self):
        self.x = 0.0
        self.gripped = False
        self.part_at = 0.5

    def move(self, x):
        self.x += x
        if self.gripped:
            self.part_at = self.x

    def grip(self, closed):
        self.gripped = closed and abs(self.x - self.part_at) < 0.01
