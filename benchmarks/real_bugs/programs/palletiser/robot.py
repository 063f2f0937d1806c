"""A robot with a vacuum cup, and a scale, as plain objects."""


class Robot:
    """Is where it was sent; time passes when somebody waits."""

    def __init__(self):
        self.place = (0.0, 0.0, 0.0, 0.0)
        self.time = 0.0
        self.log = []

    def move_to(self, x, y, z, turn, speed=1.0):
        self.place = (x, y, z, turn)
        self.log.append((x, y, z, turn, speed))

    def wait(self, seconds):
        self.time += seconds


class Cup:
    """Has a vacuum 0.2 s after it grips, if there is a box."""

    def __init__(self, robot, boxes=100):
        self.robot, self.boxes = robot, boxes
        self.since = None
        self.log = []

    def grip(self):
        self.since = self.robot.time
        self.log.append(("grip", self.robot.place[:3]))

    def release(self):
        if self.since is not None and self.boxes > 0:
            self.boxes -= 1
        self.since = None
        self.log.append(("release", self.robot.place[:3]))

    def has_vacuum(self):
        return self.since is not None and self.boxes > 0 and self.robot.time >= self.since + 0.2


class Scale:
    """Weighs in grams."""

    def __init__(self, grams=5000.0):
        self.grams = grams

    def read(self):
        return self.grams
