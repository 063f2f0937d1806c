"""Units and their conversion."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mutabot.model.values.units import UNITS, Dimension, convert, dimension_of

values = st.floats(-1e9, 1e9)
pairs = st.sampled_from([(a, b) for a in UNITS for b in UNITS if dimension_of(a) is dimension_of(b)])


@given(value=values, units=pairs)
def test_a_value_survives_the_way_to_another_unit_and_back(value: float, units: tuple[str, str]) -> None:
    unit, other = units
    assert convert(convert(value, unit, other), other, unit) == pytest.approx(value, rel=1e-12, abs=1e-300)


@given(value=values, units=pairs, middle=st.sampled_from(sorted(UNITS)))
def test_a_detour_over_a_third_unit_changes_nothing(
    value: float, units: tuple[str, str], middle: str
) -> None:
    unit, other = units
    if dimension_of(middle) is dimension_of(unit):
        detour = convert(convert(value, unit, middle), middle, other)
        assert detour == pytest.approx(convert(value, unit, other), rel=1e-12, abs=1e-300)


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


@pytest.mark.parametrize(
    ("unit", "to"), [(a, b) for a in UNITS for b in UNITS if dimension_of(a) is not dimension_of(b)]
)
def test_units_of_different_dimensions_are_not_converted(unit: str, to: str) -> None:
    with pytest.raises(ValueError, match="cannot convert"):
        convert(1.0, unit, to)


def test_the_si_unit_of_a_dimension_has_the_factor_one() -> None:
    found = {unit: dimension for unit, (dimension, factor) in UNITS.items() if factor == 1.0}
    expected = {
        "m": Dimension.LENGTH,
        "rad": Dimension.ANGLE,
        "s": Dimension.TIME,
        "fraction": Dimension.RATIO,
    }
    assert found == expected
