from enum import Enum


class Joint(Enum):
    LIFT = "lift"
    TURN = "turn"

    def __init__(self, name):
        self.at = 0.0


class Arm:
    def lift(self, dz):
        Joint.LIFT.at = round(Joint.LIFT.at + dz, 6)

    def turn(self, angle):
        Joint.TURN.at += angle
