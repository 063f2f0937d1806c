import mission
import pytest
from robot import Arm


@pytest.mark.parametrize(
    "offsets, x", [([(0.25, -0.25), (0.5,)], 0.75), ([(1.0, 0.0)], 1.0)], ids=["two", "one"]
)
def test_position(offsets, x):
    arm = Arm()
    mission.pack(arm, offsets)
    assert arm.x == x


def test_height():
    arm = Arm()
    mission.pack(arm, [(0.0, -0.25)])
    assert arm.z == pytest.approx(0.05)
