class Cell:
    """A pusher that takes parts from a magazine."""

    def __init__(self, parts):
        self.parts = parts
        self.tray = 0
        self.stroke = 0.0
        self.colour = "off"
        self.strokes = 0

    def push(self, distance):
        self.strokes += 1
        if self.strokes > 500:
            raise RuntimeError("the pusher is worn out")
        self.stroke += distance
        if self.stroke >= 40.0 and self.parts:
            self.parts -= 1
            self.tray += 1
        self.stroke = max(self.stroke, 0.0)

    def sensor(self):
        return self.parts > 0

    def lamp(self, colour):
        self.colour = colour
