import mission
import pytest
from robot import Arm

arm = Arm()
strokes = mission.sweep(arm)


def test_first_stroke():
    assert next(strokes) == 0.5


def test_second_stroke():
    assert next(strokes) == 0.5
    assert arm.angle == 30


def test_clean():
    other = Arm()
    assert len(mission.clean(other)) == 2
    assert other.resting
