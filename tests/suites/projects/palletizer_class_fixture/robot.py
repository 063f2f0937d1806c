"""A palletising arm: height and swing angle."""


class LimitError(Exception):
    """An axis limit."""


class World:
    def __init__(self):
        self.height = 0.0
        self.angle = 0.0
        self.holding = False
        self.stacked = []


class Arm:
    def __init__(self, world):
        self.world = world

    def home(self):
        self.world.height = 0.0
        self.world.angle = 0.0

    def lift(self, dz):
        if self.world.height + dz < -0.5:
            raise LimitError("below the floor")
        self.world.height += dz

    def swing(self, angle):
        self.world.angle = angle


class Gripper:
    def __init__(self, world):
        self.world = world

    def close(self):
        self.world.holding = True

    def open(self):
        if self.world.holding:
            self.world.stacked.append((round(self.world.angle), round(self.world.height, 3)))
        self.world.holding = False
