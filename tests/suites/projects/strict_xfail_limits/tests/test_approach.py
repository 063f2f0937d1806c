import mission
import pytest
from robot import Arm, Collision


def test_approach_ends_low():
    assert mission.approach(Arm()) > 0


@pytest.mark.xfail(strict=True, raises=Collision, reason="nobody raises the arm first")
def test_from_low_down():
    mission.approach(Arm(0.5))


@pytest.mark.xfail(reason="known to end too high", strict=False)
def test_exact_height():
    arm = Arm()
    mission.approach(arm)
    mission.withdraw(arm)
    assert arm.z == 0.5


def test_withdraw_if_the_arm_is_low():
    arm = Arm(0.6)
    if arm.height() > 0.8:
        pytest.skip("nothing to withdraw from")
    mission.withdraw(arm)
    if arm.z < 0.7:
        pytest.skip("still low")


@pytest.mark.xfail(strict=True)
def test_withdraw_goes_too_far():
    arm = Arm()
    mission.withdraw(arm)
    assert arm.z < 1.1
