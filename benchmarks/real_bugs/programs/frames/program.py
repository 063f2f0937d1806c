"""Grasps what a camera at the hand sees: frames in the plane."""

import math
from dataclasses import dataclass

METRES_PER_COUNT = 0.0001
TOUCH = 2.0


@dataclass(frozen=True)
class Frame:
    """A place and a turn."""

    x: float = 0.0
    y: float = 0.0
    turn: float = 0.0

    def __matmul__(self, other):
        cos, sin = math.cos(self.turn), math.sin(self.turn)
        return Frame(
            self.x + cos * other.x - sin * other.y,
            self.y + sin * other.x + cos * other.y,
            self.turn + other.turn,
        )

    def inverse(self):
        cos, sin = math.cos(self.turn), math.sin(self.turn)
        return Frame(-cos * self.x - sin * self.y, sin * self.x - cos * self.y, -self.turn)


CAMERA = Frame(0.05, 0.0, 0.0)
TOOL = Frame(0.12, 0.0, 0.0)


class Grasper:
    """The program."""

    def __init__(self, arm, sensors):
        self.arm, self.sensors = arm, sensors

    def hand(self):
        return Frame(*self.arm.read_pose())

    def seen(self, angle):
        distance = self.sensors.depth() * METRES_PER_COUNT
        return Frame(distance * math.cos(angle), distance * math.sin(angle), angle)

    def part(self, angle):
        return self.hand() @ CAMERA @ self.seen(angle)

    def approach(self, angle, stand_off=0.0):
        goal = self.part(angle) @ Frame(-stand_off) @ TOOL.inverse()
        self.arm.move_to(goal.x, goal.y, goal.turn)

    def nudge(self, ahead, left):
        goal = self.hand() @ Frame(ahead, left)
        self.arm.move_to(goal.x, goal.y, goal.turn)

    def has_part(self):
        return self.sensors.left_force() > TOUCH and self.sensors.right_force() > TOUCH

    def leaning(self):
        return self.sensors.left_force() - self.sensors.right_force()

    def between(self, start, end, share):
        return Frame(
            start.x + share * (end.x - start.x),
            start.y + share * (end.y - start.y),
            start.turn + share * (end.turn - start.turn),
        )

    def halfway(self, goal):
        step = self.between(self.hand(), goal, 0.25)
        self.arm.move_to(step.x, step.y, step.turn)
