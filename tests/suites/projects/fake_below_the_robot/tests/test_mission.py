from unittest.mock import MagicMock, call

import mission
import pytest
from robot import Arm


class FakeArm(Arm):
    def __init__(self):
        self.z, self.is_open = 0.0, False

    def lift(self, height):
        self.z += height

    def height(self):
        return self.z

    def open(self):
        self.is_open = True

    def close(self):
        self.is_open = False


@pytest.fixture
def arm():
    return FakeArm()


def test_is_closed_below(arm):
    mission.fill(arm, [0.2, 0.3])
    assert not arm.is_open


def test_stays_open_above(arm):
    mission.fill(arm, [2.0])
    assert arm.is_open


def test_closes_after_each():
    arm = MagicMock()
    arm.height.side_effect = [0.2, 3.0]
    mission.fill(arm, (0.2, 2.8))
    assert arm.mock_calls == [
        call.lift(0.2), call.open(), call.height(), call.close(), call.lift(2.8), call.open(), call.height(),
    ]  # fmt: skip
