"""Which parts are sorted, and when."""

import pytest
from robot import Belt, Bus, Flipper

from program import Sorter


def made():
    belt = Belt()
    sorter = Sorter(Bus(), belt, Flipper(belt))
    sorter.start()
    return sorter


def see(sorter, label, at=0, share=0.9):
    sorter.bus.arrives("part", label, share, at)
    sorter.bus.arrives("part", label, share, at)


def test_not_before_it_is_there():
    sorter = made()
    see(sorter, "nut")
    sorter.step(1.9)
    assert not sorter.flipper.log
    sorter.step(2.0)
    assert sorter.report() == {"nut": 1}


@pytest.mark.parametrize(("label", "due"), [("nut", 2.0), ("bolt", 3.5), ("washer", 5.0)])
def test_each_has_its_bin(label, due):
    assert made().due(label, 0.0) == pytest.approx(due)


def test_other_parts_go_on():
    sorter = made()
    see(sorter, "spring")
    sorter.step(7.5)
    assert sorter.report() == {"other": 1}
    assert not sorter.flipper.log


def test_unsure_parts_are_left():
    sorter = made()
    see(sorter, "nut", share=0.7)
    assert sorter.queue == []


def test_once_is_not_enough():
    sorter = made()
    sorter.bus.arrives("part", "nut", 0.9, 0)
    assert sorter.queue == []


def test_a_stopped_belt_stands():
    sorter = made()
    sorter.stop()
    assert sorter.belt.speed == 0.0
    assert not sorter.is_running


def test_a_jam_stops_the_belt():
    sorter = made()
    sorter.bus.arrives("jam", "bolt")
    assert sorter.belt.speed == 0.0
    assert sorter.bus.log == [("alarm", "jam at bolt")]
