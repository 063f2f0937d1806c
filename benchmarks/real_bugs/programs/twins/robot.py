"""Two arms with hands, and a panel with two buttons, as plain objects."""


class Arm:
    """Is where it was sent. A motion that is not waited for ends with the next call."""

    def __init__(self, place=(0.3, 0.2, 0.1), feels=True):
        self.joints = [0.0, 0.0, 0.0]
        self.place = place
        self.something = feels
        self.enabled = False
        self.log = []

    def enable(self):
        self.enabled = True
        self.log.append("enable")

    def disable(self):
        self.enabled = False
        self.log.append("disable")

    def halt(self):
        self.log.append("halt")

    def move_joints(self, angles, blocking=True):
        self.joints = angles
        self.log.append(("joints", list(angles), blocking))

    def move_place(self, x, y, z, blocking=True):
        self.place = (x, y, z)
        self.log.append(("place", x, y, z, blocking))

    def read_joints(self):
        return self.joints

    def read_place(self):
        return self.place

    def close_hand(self, force=20.0):
        self.log.append(("close", force))

    def open_hand(self):
        self.log.append("open")

    def feels(self):
        return self.something


class Panel:
    """Two buttons."""

    def __init__(self, left=False, right=False):
        self.left, self.right = left, right

    def left_pressed(self):
        return self.left

    def right_pressed(self):
        return self.right
