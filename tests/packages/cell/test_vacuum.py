"""The vacuum in a cup obeys the balance of the air in it; each expectation is derived here."""

from __future__ import annotations

import math

import pytest

from mutabot_cell.models.vacuum import AIR_DENSITY, ATMOSPHERE, Ejector, Vacuum

EJECTOR = Ejector()


def after(seconds: float, opening: float = 0.0, step: float = 0.001) -> float:
    vacuum = Vacuum(EJECTOR)
    for _ in range(round(seconds / step)):
        vacuum.advance(step, opening, is_on=True)
    return vacuum.pressure


def test_a_tight_cup_is_evacuated_with_the_time_constant_of_its_volume_and_suction_rate() -> None:
    constant = EJECTOR.volume / EJECTOR.flow * EJECTOR.limit / ATMOSPHERE
    assert constant == pytest.approx(0.12, abs=0.01)
    for times in (0.5, 1.0, 2.0):
        assert after(times * constant) == pytest.approx(EJECTOR.limit * (1 - math.exp(-times)), rel=0.01)


def test_a_tick_of_10_ms_makes_little_difference() -> None:
    assert after(0.2, step=0.01) == pytest.approx(after(0.2), rel=0.03)


@pytest.mark.parametrize("opening", [1e-8, 2e-7, 2e-6])
def test_with_a_leak_the_vacuum_settles_where_as_much_is_drawn_as_comes_in(opening: float) -> None:
    pressure = after(3.0, opening)
    drawn = EJECTOR.flow * (1 - pressure / EJECTOR.limit)
    leaks = 0.6 * opening * math.sqrt(2 * pressure / AIR_DENSITY)
    assert drawn == pytest.approx(leaks, rel=1e-6)


def test_a_larger_leak_leaves_less_vacuum() -> None:
    found = [after(3.0, opening) for opening in (0.0, 1e-7, 2e-7, 1e-6, 1e-5)]
    assert found == sorted(found, reverse=True)
    assert found[0] == pytest.approx(EJECTOR.limit, rel=1e-6)


def test_a_cup_that_touches_nothing_has_no_vacuum_to_speak_of() -> None:
    assert after(3.0, math.pi * 0.015**2, step=0.01) < 0.001 * ATMOSPHERE


def test_switched_off_air_comes_back_within_some_hundredths_of_a_second() -> None:
    vacuum = Vacuum(EJECTOR)
    vacuum.pressure = 60e3
    pressures = []
    for _ in range(6):
        vacuum.advance(0.01, 0.0, is_on=False)
        pressures.append(vacuum.pressure)
    assert pressures == sorted(pressures, reverse=True)
    assert pressures[-1] < 1e3
