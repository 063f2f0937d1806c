"""It docks."""

from robot import Base, Charger, Eye

from program import Dock


def made(percent=15.0, **more):
    base = Base(**more)
    return Dock(base, Eye(base), Charger(base, percent))


def test_it_docks():
    assert made().run()


def test_it_needs_charge():
    assert made().needs_charge()


def test_a_full_battery():
    assert made(99.0).run()
