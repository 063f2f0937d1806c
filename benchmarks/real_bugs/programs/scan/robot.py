"""A laser scanner, a localisation and a base, as plain objects."""

from dataclasses import dataclass, field


@dataclass
class Scan:
    """Ranges in metres from the first angle on, in radians; the stamp in seconds."""

    ranges: list = field(default_factory=list)
    first: float = -0.5
    step: float = 0.25
    stamp: float = 0.0


class Laser:
    """Has one scan."""

    def __init__(self, *ranges, **more):
        self.scan = Scan(list(ranges), **more)

    def read_scan(self):
        return self.scan


class Pose:
    """Where the robot is: a quaternion has its scalar part first."""

    def __init__(self, position=(0.0, 0.0, 0.0), orientation=(1.0, 0.0, 0.0, 0.0)):
        self.position, self.orientation = position, orientation

    def read_position(self):
        return self.position

    def read_orientation(self):
        return self.orientation


class Base:
    """Does what it is asked; turns in degrees."""

    def __init__(self):
        self.log = []

    def stop(self):
        self.log.append("stop")

    def limit(self, share):
        self.log.append(("limit", share))

    def turn(self, degrees):
        self.log.append(("turn", degrees))
