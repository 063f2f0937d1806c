"""Parts are sorted."""

from robot import Belt, Bus, Flipper

from program import Sorter


def made():
    belt = Belt()
    sorter = Sorter(Bus(), belt, Flipper(belt))
    sorter.start()
    return sorter


def test_a_nut():
    sorter = made()
    sorter.bus.arrives("part", "nut", 0.9, 0)
    sorter.bus.arrives("part", "nut", 0.9, 100)
    sorter.step(2.1)
    assert sorter.flipper.log


def test_it_runs():
    assert made().belt.speed > 0


def test_a_jam():
    sorter = made()
    sorter.bus.arrives("jam", "bolt")
    assert sorter.bus.log
