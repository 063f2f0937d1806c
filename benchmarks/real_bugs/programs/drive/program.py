"""Drives a base with two wheels: odometry from ticks, and speeds of its wheels."""

import math

TICKS_PER_TURN = 2048
GEAR_RATIO = 9.5
RADIUS = 0.08
TRACK = 0.5
FASTEST = 1.2
TIMEOUT = 0.5


class Drive:
    """The program."""

    def __init__(self, left, right, clock):
        self.left, self.right, self.clock = left, right, clock
        self.x = self.y = self.heading = 0.0
        self.last = (left.read_ticks(), right.read_ticks())
        self.commanded = None
        self.limit = FASTEST

    def metres(self, ticks):
        return ticks / TICKS_PER_TURN / GEAR_RATIO * 2 * math.pi * RADIUS

    def update(self):
        now = (self.left.read_ticks(), self.right.read_ticks())
        left = self.metres(now[0] - self.last[0])
        right = self.metres(now[1] - self.last[1])
        self.last = now
        ahead, turn = (left + right) / 2, (right - left) / TRACK
        middle = self.heading + turn / 2
        self.x += ahead * math.cos(middle)
        self.y += ahead * math.sin(middle)
        self.heading = math.remainder(self.heading + turn, 2 * math.pi)

    def command(self, speed, turning):
        left = speed - turning * TRACK / 2
        right = speed + turning * TRACK / 2
        largest = max(abs(left), abs(right))
        if largest > self.limit:
            left, right = left * self.limit / largest, right * self.limit / largest
        self.left.set_speed(self.turns(left))
        self.right.set_speed(-self.turns(right))
        self.commanded = self.clock.now()

    def turns(self, speed):
        """Turns of the motor per minute."""
        return speed / (2 * math.pi * RADIUS) * GEAR_RATIO * 60

    def watch(self):
        if self.commanded is not None and self.clock.now() - self.commanded > TIMEOUT:
            self.stop()

    def stop(self):
        self.left.set_speed(0.0)
        self.right.set_speed(0.0)
        self.commanded = None

    def creep(self, metres):
        """Go ahead slowly; the limit is then what it was."""
        before = self.limit
        self.limit = 0.2
        self.command(math.copysign(1.0, metres), 0.0)
        self.clock.sleep(abs(metres) / self.limit)
        self.stop()
        self.limit = before

    def reset(self):
        self.x = self.y = self.heading = 0.0
        self.last = (self.left.read_ticks(), self.right.read_ticks())

    def pose(self):
        return self.x, self.y, self.heading
