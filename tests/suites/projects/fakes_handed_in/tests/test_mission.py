from types import SimpleNamespace

import mission
import pytest


class FakeArm:
    def __init__(self):
        self.x, self.log = 0.0, []

    def move_by(self, dx, speed=0.1):
        self.x += dx
        self.log.append(speed)

    def vacuum(self, on):
        self.log.append(on)

    def position(self):
        return self.x


@pytest.fixture
def arm():
    return FakeArm()


def test_stacks(arm):
    assert mission.Stacker(arm).stack(0.25) == pytest.approx(0.25)


def test_holds_the_part_meanwhile(arm):
    mission.Stacker(arm).stack(0.25)
    assert arm.log[0] is True


def test_names_the_speed():
    said = []
    arm = SimpleNamespace(
        move_by=lambda dx, **more: said.append(more), vacuum=lambda on: None, position=lambda: 1.0
    )
    mission.Stacker(arm).stack(0.1)
    assert said == [{}, {"speed": 0.3}]
