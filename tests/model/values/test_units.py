"""Units and their conversion."""

from __future__ import annotations

import math

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mutabot.model.units import UNITS, Dimension, convert, convert_difference, dimension_of

values = st.floats(-1e9, 1e9)
pairs = st.sampled_from([(a, b) for a in UNITS for b in UNITS if dimension_of(a) is dimension_of(b)])


@given(value=values, units=pairs)
def test_a_value_survives_the_way_to_another_unit_and_back(value: float, units: tuple[str, str]) -> None:
    unit, other = units
    assert convert(convert(value, unit, other), other, unit) == pytest.approx(value, rel=1e-9, abs=1e-9)


@given(value=values, units=pairs, middle=st.sampled_from(sorted(UNITS)))
def test_a_detour_over_a_third_unit_changes_nothing(
    value: float, units: tuple[str, str], middle: str
) -> None:
    unit, other = units
    if dimension_of(middle) is dimension_of(unit):
        detour = convert(convert(value, unit, middle), middle, other)
        # where zeros differ, numbers near one of them are rounded as sums with the distance of the zeros
        rounding = 8 * math.ulp(500.0) if dimension_of(unit) is Dimension.TEMPERATURE else 1e-300
        assert detour == pytest.approx(convert(value, unit, other), rel=1e-12, abs=rounding)


@given(value=values, unit=st.sampled_from(sorted(UNITS)))
def test_the_same_unit_leaves_the_value_untouched(value: float, unit: str) -> None:
    assert convert(value, unit, unit) is value


@pytest.mark.parametrize(
    ("value", "unit", "to", "expected"),
    [
        (1, "m", "cm", 100),
        (25, "mm", "cm", 2.5),
        (180, "deg", "rad", math.pi),
        (1500, "ms", "s", 1.5),
        (50, "percent", "fraction", 0.5),
    ],
)
def test_conversions_are_those_of_the_textbook(value: float, unit: str, to: str, expected: float) -> None:
    assert convert(value, unit, to) == pytest.approx(expected, rel=1e-15)


def test_units_of_different_dimensions_are_not_converted() -> None:
    for unit in UNITS:
        for to in UNITS:
            if dimension_of(unit) is not dimension_of(to):
                with pytest.raises(ValueError, match="cannot convert"):
                    convert(1.0, unit, to)


REGISTRY = pint.UnitRegistry()
#: how pint calls what it does not know by our name
IN_PINT = {"Nm": "newton * meter", "Nmm": "newton * millimeter", "fraction": "dimensionless"}


def test_every_conversion_is_that_of_a_library_of_units() -> None:
    alike = [(a, b) for a in UNITS for b in UNITS if dimension_of(a) is dimension_of(b)]
    ours = {pair: convert(20.0, *pair) for pair in alike}
    theirs = {
        (unit, to): REGISTRY.Quantity(20.0, IN_PINT.get(unit, unit)).to(IN_PINT.get(to, to)).magnitude
        for unit, to in alike
    }
    assert ours == pytest.approx(theirs, rel=1e-9)


def test_a_difference_of_temperatures_does_not_know_where_scales_begin() -> None:
    assert convert_difference(9.0, "degF", "degC") == pytest.approx(5.0)
    assert convert(9.0, "degF", "degC") == pytest.approx(-12.777777777777779)


@pytest.mark.parametrize("dimension", Dimension)
def test_each_dimension_has_one_unit_with_the_factor_one_that_begins_at_zero(dimension: Dimension) -> None:
    units = [unit for unit in UNITS.values() if unit.dimension is dimension]
    assert [unit.factor for unit in units if unit.factor == 1.0 and not unit.zero] == [1.0]
