"""Welds seams: approach, arc on, along the seam, arc off, away."""

import math

CLEAR = 0.05
THIN, THICK = 3.0, 6.0
TORCH = 0.35
HOME = (0.0, 0.0, 0.5)
PARK = (0.6, 0.0, 0.5)


class Welder:
    """The program."""

    def __init__(self, arm, source):
        self.arm, self.source = arm, source
        self.length = 0.0
        self.faults = 0

    def weld(self, points, thickness, weave=False):
        self.length = 0.0
        if len(points) < 2 or not self.ready():
            return False
        self.above(points[0])
        self.down(points[0])
        self.source.set_current(self.current(thickness))
        self.source.on()
        self.source.wait(0.2)
        if not self.source.is_burning():
            self.abort()
            return False
        for start, end in zip(points, points[1:]):
            self.along(start, end, thickness, weave)
        self.source.wait(0.1)
        self.source.off()
        self.above(points[-1])
        return True

    def ready(self):
        return self.source.gas() > 0.5 and not self.source.is_burning()

    def current(self, thickness):
        if thickness <= THIN:
            return 80.0
        if thickness >= THICK:
            return 200.0
        return 80.0 + (thickness - THIN) / (THICK - THIN) * 120.0

    def speed(self, thickness):
        return 600.0 / thickness / 1000.0 / 60.0

    def above(self, point):
        self.arm.move_to(point[0], point[1], point[2] + TORCH + CLEAR)

    def down(self, point):
        self.arm.move_to(point[0], point[1], point[2] + TORCH, speed=0.05)

    def along(self, start, end, thickness, weave):
        speed = self.speed(thickness)
        if weave:
            speed = speed / 2
        self.arm.move_to(end[0], end[1], end[2] + TORCH, speed=speed)
        self.length += math.dist(start, end)

    def abort(self):
        self.source.off()
        self.faults += 1
        self.arm.move_to(*HOME)

    def park(self):
        self.arm.move_to(*PARK)
        self.faults = 0
