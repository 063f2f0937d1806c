"""An arm with a depth camera at its hand and two finger sensors, as plain objects."""


class Arm:
    """Is where it was sent: x, y and the turn of its hand."""

    def __init__(self, pose=(0.0, 0.0, 0.0)):
        self.pose = pose
        self.sent = []

    def move_to(self, x, y, turn):
        self.pose = (x, y, turn)
        self.sent.append(self.pose)

    def read_pose(self):
        return self.pose


class Sensors:
    """Depth in counts of 0.1 mm, and what both fingers feel."""

    def __init__(self, counts=5000, left=0.0, right=0.0):
        self.counts, self.left, self.right = counts, left, right

    def depth(self):
        return self.counts

    def left_force(self):
        return self.left

    def right_force(self):
        return self.right
