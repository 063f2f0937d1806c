import mission
from robot import Agv


def test_trouble():
    agv = Agv()
    assert mission.deliver(agv) == []
    assert agv.resets == 0


def test_bells():
    agv = Agv()
    mission.deliver(agv)
    assert agv.bells in (3, 6)


def test_after_a_bad_start():
    agv = Agv()
    agv.way = 5.0
    assert len(mission.deliver(agv)) == 2
