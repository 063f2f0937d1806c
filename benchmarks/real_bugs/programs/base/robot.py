"""A mobile base, as a plain object."""

import math


class Base:
    """Drives as it is told, at once."""

    def __init__(self, x=0.0, y=0.0, heading=0.0):
        self.x, self.y, self.heading = x, y, heading
        self.ticks = {"left": 0, "right": 0}
        self.speeds = (0.0, 0.0, 0.0)

    def velocity(self, forward, sideways, turn):
        self.speeds = (forward, sideways, turn)

    def step(self, seconds):
        forward, sideways, turn = self.speeds
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        self.x += (cos * forward - sin * sideways) * seconds
        self.y += (sin * forward + cos * sideways) * seconds
        self.heading += turn * seconds

    def read_heading(self):
        return self.heading
