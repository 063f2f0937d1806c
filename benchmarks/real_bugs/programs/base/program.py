"""Drives a base by joystick and to headings."""

import math

MOST = 0.8
SEEN_AHEAD = 0.25


def wrap(angle):
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def shaped(value):
    return math.copysign(value * value, value)


def limited(speed, most=MOST):
    return max(-most, min(speed, most))


class Driver:
    """The program."""

    def __init__(self, base):
        self.base = base

    def joystick(self, x, y, turn=0.0):
        if abs(x) < 0.05 and abs(y) < 0.05 and not turn:
            self.stop()
            return
        self.base.velocity(limited(shaped(y)), limited(shaped(-x)), turn)

    def stop(self):
        self.base.velocity(0.0, 0.0, 0.0)

    def turn_to(self, goal, steps=40):
        for _ in range(steps):
            gap = wrap(goal - self.base.read_heading())
            if abs(gap) < 0.01:
                break
            self.base.velocity(0.0, 0.0, limited(2.0 * gap))
            self.base.step(0.25)
        self.stop()

    def goal_from(self, ahead, left):
        heading = self.base.read_heading()
        cos, sin = math.cos(heading), math.sin(heading)
        return self.base.x + cos * ahead - sin * left, self.base.y + sin * ahead + cos * left

    def heading_of(self, seen, turned_since):
        return wrap(seen + self.base.read_heading() - turned_since)
