"""How parts are sorted."""

import pytest
from robot import Belt, Bus, Flipper

from program import Sorter


def made():
    belt = Belt()
    sorter = Sorter(Bus(), belt, Flipper(belt))
    sorter.start()
    return sorter


def see(sorter, label, at=0, times=2):
    for _ in range(times):
        sorter.bus.arrives("part", label, 0.9, at)


def test_the_time_of_a_picture_is_in_milliseconds():
    sorter = made()
    see(sorter, "nut", 1500)
    assert sorter.queue == [("nut", 1.5)]


def test_a_part_that_is_seen_on_is_one():
    sorter = made()
    see(sorter, "nut", times=5)
    assert len(sorter.queue) == 1


def test_two_kinds_in_turn_are_none():
    sorter = made()
    for label in ("nut", "bolt", "nut", "bolt"):
        see(sorter, label, times=1)
    assert sorter.queue == []


def test_the_flipper_is_out_for_a_while():
    sorter = made()
    see(sorter, "nut")
    sorter.step(2.0)
    assert sorter.flipper.log == [("out", "nut", 0.0), ("in", pytest.approx(0.15))]
    assert not sorter.flipper.is_out


def test_what_has_passed_is_missed():
    sorter = made()
    see(sorter, "nut")
    sorter.step(2.3)
    assert sorter.report() == {"missed": 1}
    assert not sorter.flipper.log


def test_those_that_are_not_due_stay():
    sorter = made()
    see(sorter, "nut")
    see(sorter, "bolt")
    sorter.step(2.0)
    assert [label for label, _ in sorter.queue] == ["bolt"]


def test_what_is_sorted_is_told():
    sorter = made()
    see(sorter, "bolt")
    sorter.step(3.5)
    assert sorter.bus.log == [("sorted", "bolt")]


def test_after_a_jam_nothing_waits_and_the_flipper_is_in():
    sorter = made()
    see(sorter, "nut")
    sorter.flipper.extend("nut")
    sorter.bus.arrives("jam", "nut")
    assert sorter.queue == []
    assert not sorter.flipper.is_out


def test_a_stopped_sorter_hears_nothing():
    sorter = made()
    sorter.stop()
    see(sorter, "nut")
    sorter.bus.arrives("jam", "nut")
    assert sorter.queue == []
    assert sorter.bus.log == []


def test_after_a_new_start_parts_are_counted_once_and_from_zero():
    sorter = made()
    see(sorter, "nut")
    sorter.step(2.0)
    see(sorter, "bolt")
    sorter.stop()
    sorter.start()
    assert sorter.report() == {}
    assert sorter.queue == []
    see(sorter, "bolt")
    assert len(sorter.queue) == 1


def test_after_a_new_start_a_part_must_be_seen_twice():
    sorter = made()
    see(sorter, "bolt", times=1)
    sorter.stop()
    sorter.start()
    see(sorter, "bolt", times=1)
    assert sorter.queue == []


def test_a_report_stays_as_it_was():
    sorter = made()
    before = sorter.report()
    see(sorter, "nut")
    sorter.step(2.0)
    assert before == {}
