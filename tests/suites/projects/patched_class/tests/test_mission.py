import mission
import pytest


class FakeGripper:
    made = None

    def __init__(self, address):
        self.widths, self.is_closed = [], False
        FakeGripper.made = self

    def open_to(self, width):
        self.widths.append(width)

    def close(self):
        self.is_closed = True


@pytest.fixture
def in_mission(monkeypatch):
    monkeypatch.setattr("mission.Gripper", FakeGripper)


@pytest.fixture
def in_robot(monkeypatch):
    monkeypatch.setattr("robot.Gripper", FakeGripper)


def test_holds(in_mission):
    assert mission.hold().widths == [0.08]


def test_closes(in_mission):
    assert mission.hold().is_closed


def test_lets_go(in_robot):
    mission.let_go()
    assert FakeGripper.made.widths == [0.1]
