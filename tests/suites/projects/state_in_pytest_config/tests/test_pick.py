import mission
import pytest
from robot import Arm

ARM = pytest.StashKey()


def test_pick_runs(pytestconfig):
    pytestconfig.stash[ARM] = Arm()
    mission.pick(pytestconfig.stash[ARM])


def test_angle_afterwards(pytestconfig):
    assert pytestconfig.stash[ARM].angle == 30.0
