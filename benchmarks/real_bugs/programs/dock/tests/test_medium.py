"""What it does to dock."""

from robot import Base, Charger, Eye

from program import Dock


def made(percent=15.0, blind=False, works=True, **more):
    base = Base(**more)
    return Dock(base, Eye(base, blind=blind), Charger(base, percent, works))


def test_it_charges():
    dock = made()
    dock.run()
    assert dock.charger.percent() >= 95.0


def test_it_leaves_the_charger():
    dock = made()
    dock.run()
    assert dock.base.place < -0.2
    assert dock.state == "idle"


def test_without_a_marker_it_gives_up():
    dock = made(blind=True)
    assert not dock.run()
    assert dock.state == "failed"


def test_it_tries_three_times():
    dock = made(works=False)
    assert not dock.run()
    assert dock.tries == 3


def test_a_full_battery_is_left_alone():
    dock = made(99.0)
    dock.run()
    assert dock.base.log == []


def test_half_full_is_no_need():
    assert not made(50.0).needs_charge()


def test_the_charger_is_off_at_the_end():
    dock = made()
    dock.run()
    assert dock.charger.log == ["on", "off"]
