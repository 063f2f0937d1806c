class Pen:
    def __init__(self):
        self.x = self.y = 0
        self.down = False
        self.lines = []

    def go(self, x, y):
        if self.down:
            self.lines.append((self.x, self.y, x, y))
        self.x, self.y = x, y
        return self

    def lower(self):
        self.down = True
        return self

    def lift(self):
        self.down = False
        return self

    def length(self):
        return sum(abs(c - a) + abs(d - b) for a, b, c, d in self.lines)
