import mission
import pytest
from robot import Arm


def test_pick_runs():
    pytest.arm = Arm()
    mission.pick(pytest.arm)


def test_height_afterwards():
    assert pytest.arm.z == 0.15
