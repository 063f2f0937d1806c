import mission
from robot import Pen


def test_length():
    assert mission.engrave(Pen()) == 50


def test_two_lines():
    pen = Pen()
    mission.engrave(pen)
    assert len(pen.lines) == 2
    assert not pen.down
