import math


class Tool:
    def __init__(self):
        self.x = self.y = 0.0
        self.heading = 0
        self.path = [(0.0, 0.0)]
        self.running = True

    def along(self, mm):
        self.x += mm * math.cos(math.radians(self.heading))
        self.y += mm * math.sin(math.radians(self.heading))
        self.path.append((round(self.x, 6), round(self.y, 6)))

    def turn(self, degrees):
        self.heading = (self.heading + degrees) % 360

    def stop(self):
        self.running = False
