"""Makes points on a map of what a laser scanner sees, and says what is in the way."""

import math

MOUNT = (0.2, 0.0, 0.15)
NEAREST, FARTHEST = 0.1, 8.0
WIDTH = 0.6
WARN, STOP = 1.5, 0.6
STALE = 0.3


def yaw_of(quaternion):
    """The turn about z of a quaternion w, x, y, z."""
    w, x, y, z = quaternion
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def quaternion_of(yaw):
    return (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))


class Scanner:
    """The program."""

    def __init__(self, laser, pose, base):
        self.laser, self.pose, self.base = laser, pose, base
        self.points = []
        self.slowed = False

    def read(self):
        """Points in the frame of the robot, of ranges that can be believed."""
        scan = self.laser.read_scan()
        found = []
        for index, distance in enumerate(scan.ranges):
            if not NEAREST <= distance <= FARTHEST:
                continue
            angle = scan.first + index * scan.step
            found.append(self.in_robot(distance * math.cos(angle), distance * math.sin(angle)))
        return found

    def in_robot(self, x, y):
        turn = MOUNT[2]
        return (
            MOUNT[0] + x * math.cos(turn) - y * math.sin(turn),
            MOUNT[1] + x * math.sin(turn) + y * math.cos(turn),
        )

    def in_map(self, point):
        x, y, _ = self.pose.read_position()
        yaw = yaw_of(self.pose.read_orientation())
        return (
            x + point[0] * math.cos(yaw) - point[1] * math.sin(yaw),
            y + point[0] * math.sin(yaw) + point[1] * math.cos(yaw),
        )

    def in_base(self, point):
        x, y, _ = self.pose.read_position()
        yaw = yaw_of(self.pose.read_orientation())
        dx, dy = point[0] - x, point[1] - y
        return dx * math.cos(yaw) + dy * math.sin(yaw), dy * math.cos(yaw) - dx * math.sin(yaw)

    def add(self):
        self.points += [self.in_map(point) for point in self.read()]

    def ahead(self):
        """How far it is to what is in the way; None if nothing is."""
        ways = [x for x, y in self.read() if x > 0 and abs(y) < WIDTH / 2]
        return min(ways, default=None)

    def guard(self, now_ms):
        age = now_ms / 1000.0 - self.laser.read_scan().stamp
        gap = self.ahead()
        if age > STALE or (gap is not None and gap < STOP):
            self.base.stop()
            return "stop"
        if gap is not None and gap < WARN:
            if not self.slowed:
                self.base.limit(0.2)
                self.slowed = True
            return "slow"
        if self.slowed:
            self.base.limit(1.0)
            self.slowed = False
        return "go"

    def face(self, point):
        """Turn to a point on the map."""
        x, y = self.in_base(point)
        self.base.turn(math.degrees(math.atan2(y, x)))

    def clear(self):
        kept = self.points[:]
        self.points.clear()
        return kept
