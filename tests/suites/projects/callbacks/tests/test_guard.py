import mission
import pytest
from robot import Arm, Line


@pytest.fixture
def cell():
    line, arm = Line(), Arm()
    return line, arm, mission.Guard(line, arm)


@pytest.fixture
def near(cell):
    cell[0].part_at(0.25)
    return cell[1]


@pytest.mark.usefixtures("near")
def test_waves_only_at_far_parts(cell):
    cell[0].part_at(2.0)
    assert cell[1].waves >= 1


def test_grabs(near):
    assert near.grabbed


def test_waves_once(cell):
    line, arm, _ = cell
    line.part_at(0.75)
    assert arm.waves == 1
    assert arm.x == 0
