import mission
import pytest
from robot import Arm


@pytest.fixture(scope="session")
def arm():
    arm = Arm()
    yield arm
    arm.stop()


def test_dips(arm):
    assert mission.dip(arm, 2) >= 0


def test_two_dips(arm):
    assert arm.state()["dips"] == 2


def test_arm_is_up(arm):
    assert arm.state()["z"] == 0
