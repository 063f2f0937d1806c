import time

import mission
import pytest
from robot import Arm


@pytest.fixture
def deadline():
    return time.monotonic() + 1.0


def test_pick_in_time(deadline):
    arm = Arm()
    mission.pick(arm)
    assert time.monotonic() < deadline
    assert arm.z > 0.0


def test_pick_again_in_time(deadline):
    arm = Arm()
    mission.pick(arm)
    assert time.monotonic() < deadline
    assert arm.z < 0.4
