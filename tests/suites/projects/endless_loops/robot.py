class Rover:
    def __init__(self, wall=1.0, light=90):
        self.wall = wall
        self.light = light
        self.x = 0.0
        self.heading = 0
        self.stopped = False

    def distance(self):
        return round(self.wall - self.x, 6)

    def forward(self, m):
        self.x = round(self.x + m, 6)

    def turn(self, deg):
        self.heading += deg

    def sees_light(self):
        return self.heading == self.light

    def stop(self):
        self.stopped = True
