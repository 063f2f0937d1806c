import pytest

import mission
from robot import Cell


@pytest.fixture
def cell():
    return Cell()


def test_the_part_is_brought(cell):
    mission.run(cell)
    assert cell.held
    assert cell.place == pytest.approx([200, 300, 120], abs=1)


def test_the_way_there(cell):
    mission.run(cell)
    places = [place for what, place in cell.log if what == "at"]
    assert places[0] == pytest.approx([300, -100, 300], abs=2)
    assert places[1][2] < 200
    assert len(places) >= 3


def test_what_it_says(cell):
    said = mission.run(cell)
    assert said["refused"]
    assert said["firm"]
    assert said["colour"] == "red"
    assert said["gaps"] == sorted(said["gaps"], reverse=True)
    assert said["angles"][5] == 170
    assert said["here"][0] == pytest.approx(200, abs=1)


def test_it_is_set_up(cell):
    mission.run(cell)
    assert cell.payload == pytest.approx(1.2)
    assert 70 <= cell.force <= 80
    assert cell.time < 6
    assert cell.quaternion[0] > 0.5
    assert cell.angles[0] == pytest.approx(170, abs=5)
