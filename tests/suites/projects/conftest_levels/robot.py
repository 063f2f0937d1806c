class Agv:
    def __init__(self):
        self.way = 0.0
        self.heading = 0
        self.latched = False

    def forward(self, m):
        if not self.latched:
            self.way += m if self.heading == 0 else -m

    def turn(self, degrees):
        self.heading = (self.heading + degrees) % 360

    def latch(self):
        self.latched = abs(self.way - 2.5) < 0.1

    def unlatch(self):
        self.latched = False
