class Line:
    def __init__(self):
        self.listeners = []

    def subscribe(self, listener):
        self.listeners.append(listener)

    def part_at(self, distance):
        for listener in self.listeners:
            listener(distance)


class Arm:
    def __init__(self):
        self.x = 0.0
        self.grabbed = False
        self.waves = 0

    def forward(self, m):
        self.x += m

    def grab(self, closed):
        self.grabbed = closed

    def wave(self):
        self.waves += 1
