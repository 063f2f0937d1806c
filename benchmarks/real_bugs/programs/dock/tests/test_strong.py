"""How it docks."""

import pytest
from robot import Base, Charger, Eye

from program import Dock


def made(percent=15.0, blind=False, works=True, **more):
    base = Base(**more)
    return Dock(base, Eye(base, blind=blind), Charger(base, percent, works))


def test_the_steps():
    dock = made()
    dock.run()
    assert [after for _, after in dock.log] == ["approach", "touch", "charging", "idle"]


def test_it_turns_to_the_marker():
    dock = made()
    dock.run()
    assert dock.base.log[0] == ("turn", 0.1)


def test_far_ways_are_driven_by_the_metre():
    dock = made()
    dock.approach()
    assert [one[1] for one in dock.base.log if one[0] == "drive"] == pytest.approx([1.0, 0.7])
    assert dock.base.place == pytest.approx(-0.3)


def test_it_touches_slowly():
    dock = made(place=-0.1)
    dock.touch()
    assert {one[2] for one in dock.base.log if one[0] == "drive"} == {0.05}
    assert dock.base.place == pytest.approx(0.0, abs=0.021)


def test_it_brakes_while_it_charges_and_lets_go_afterwards():
    dock = made(place=0.0)
    dock.touch()
    assert dock.base.braked
    dock.leave()
    assert not dock.base.braked


def test_it_leaves_slowly():
    dock = made(place=0.0)
    dock.leave()
    assert dock.base.log[-1] == ("drive", -0.3, 0.05)


def test_between_tries_it_backs_off():
    dock = made(works=False)
    dock.run()
    assert ("drive", -0.3, 0.3) in dock.base.log


def test_a_second_run_has_three_tries_again():
    dock = made(works=False)
    dock.run()
    dock.charger.works = True
    assert dock.run()
    assert dock.tries <= 3
    assert dock.state == "idle"


def test_the_alarm_is_an_error():
    dock = made(blind=True)
    dock.run()
    assert dock.base.log[-1] == ("alarm", "no dock", "error")


def test_lost_contact_ends_the_charging():
    dock = made(place=-1.0)
    dock.charge()
    assert dock.base.time == 0.0


def test_it_charges_as_long_as_it_takes():
    dock = made(85.0, place=0.0)
    dock.charge()
    assert dock.base.time == pytest.approx(300.0)


def test_at_the_limit_there_is_no_need():
    assert not made(20.0).needs_charge()
    assert made(95.0).run()


def test_with_slipping_wheels_it_docks_as_well():
    assert made(slip=0.3).run()
