from types import SimpleNamespace

import mission
from robot import Arm


class Model:
    """Has the methods of an arm, and nothing to do with its class."""

    def __init__(self):
        self.log = []

    def lower(self, dz):
        self.log.append(dz)

    def grip(self, closed):
        self.log.append(closed)

    def height(self):
        return 0.0

    def swing(self, angle):
        self.log.append(angle)


def test_the_model_goes_down_and_up():
    arm = Model()
    mission.stack(arm, [0.1] * 40)
    assert arm.log == [0.1, True, -0.1, False] * 40


def test_the_model_swings():
    arm = Model()
    mission.wave(arm, 150)
    assert len(arm.log) >= 300


def test_the_arm_itself():
    assert mission.stack(Arm(), [0.25]) == 0.0


def test_the_arm_swings():
    arm = Arm()
    mission.wave(arm, 2)
    assert arm.swings >= 4


def test_another_model():
    said = []
    arm = SimpleNamespace(lower=said.append, grip=lambda closed: None, height=lambda: 1.0)
    assert mission.stack(arm, [0.1, 0.2]) == 1.0
    assert sum(said) == 0
