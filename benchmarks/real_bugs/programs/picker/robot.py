"""An arm with a gripper and a camera, as plain objects; time passes when somebody waits."""


class Arm:
    """Moves towards its target at 1 m/s while time passes."""

    def __init__(self):
        self.position = [0.0, 0.0]
        self.target = [0.0, 0.0]
        self.log = []

    def move_to(self, x, y, blocking=True):
        self.target = [x, y]
        self.log.append(("move", x, y))
        if blocking:
            self.wait(10.0)

    def wait(self, seconds):
        for index in (0, 1):
            gap = self.target[index] - self.position[index]
            step = min(abs(gap), seconds)
            self.position[index] += step if gap > 0 else -step

    def where(self):
        return self.position

    def is_moving(self):
        return self.position != self.target


class Gripper:
    """Holds what lies where it closes."""

    def __init__(self, arm, part=None):
        self.arm, self.part = arm, part
        self.force = 20.0
        self.closed = self.held = False

    def close(self, force=20.0):
        self.force, self.closed = force, True
        self.held = self.part is not None and self.part == self.arm.position

    def open(self):
        self.closed = self.held = False

    def is_holding(self):
        return self.held


class Camera:
    """Sees the part, blurred while the arm moves."""

    def __init__(self, arm, part):
        self.arm, self.part = arm, part

    def look(self):
        return None if self.arm.is_moving() else self.part
