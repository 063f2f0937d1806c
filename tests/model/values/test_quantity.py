"""Quantities: allowed values, units and how values are printed."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
import pytest

from mutabot.model import Kind, Path, Quantity
from mutabot.model.quantity import value_text


def quantity(**more: Any) -> Quantity:
    return Quantity(name="x", path=Path("x"), **{"kind": Kind.OUTPUT, **more})


@pytest.mark.parametrize(
    ("given", "value", "allowed"),
    [
        ({}, 5, True),
        ({"values": ("red", "blue")}, "red", True),
        ({"values": ("red", "blue")}, "green", False),
        ({"range": (0.0, 1.0)}, 0.0, True),
        ({"range": (0.0, 1.0)}, 1.0, True),
        ({"range": (0.0, 1.0)}, 1.01, False),
        ({"range": (0.0, 1.0), "values": (0, 1)}, 0.5, False),
    ],
)
def test_a_value_is_allowed_within_values_and_range(given: dict[str, Any], value: Any, allowed: bool) -> None:
    assert quantity(**given).allows(value) is allowed


def test_a_value_in_another_unit_is_converted_to_the_quantity_s_own() -> None:
    assert quantity(kind=Kind.DISTANCE, unit="mm").from_unit(1.5, "cm") == pytest.approx(15)
    assert quantity().from_unit(1.5, "cm") == 1.5


@pytest.mark.parametrize(
    ("unit", "value", "text"),
    [
        ("m", 0.29, "0.29 m"),
        ("deg", -80, "-80 deg"),
        ("fraction", 1, "1"),
        (None, True, "True"),
        (None, "red", "red"),
        ("m", 1 / 3, "0.333333 m"),
    ],
)
def test_a_value_is_printed_with_its_unit(unit: str | None, value: Any, text: str) -> None:
    assert quantity(unit=unit).text(value) == text


@pytest.mark.parametrize(
    ("first", "second", "texts"),
    [
        (-0.32741, 0.32741, ("-0.32741 m", "0.32741 m")),
        (-0.3274104, -0.3274101, ("-0.3274104 m", "-0.3274101 m")),
        (0.1 + 0.2, 0.3, ("0.30000000000000004 m", "0.29999999999999999 m")),
        (0.5, 0.5, ("0.5 m", "0.5 m")),
        (1234567, 1234568, ("1234567 m", "1234568 m")),
    ],
)
def test_two_values_are_printed_with_as_many_digits_as_distinguish_them(
    first: float, second: float, texts: tuple[str, str]
) -> None:
    quantity = Quantity("x", Path.parse("x", rooted=True), Kind.POSITION, unit="m")
    assert quantity.texts(first, second) == texts


def test_long_numbers_are_written_without_a_power_of_ten() -> None:
    numbers = {12345: "12345", 1000.0: "1000", -98765.4: "-98765", 0.00012345: "0.000123", 2.5e12: "2.5e+12"}
    assert {number: value_text(number, 3) for number in numbers} == numbers


@pytest.mark.parametrize(
    "value",
    [
        np.array(["left"]), np.array([True]), np.array([1j]), np.array([None]), np.array(["now"], "M8[s]"),
        np.zeros((2, 2)), np.array([(1.0,)], [("x", float)]), array("d"),
    ],
)  # fmt: skip
def test_an_array_of_other_things_than_numbers_is_none_of_numbers(value: Any) -> None:
    """A fake may get or give anything in the place of numbers."""
    assert Quantity.map_numbers(value, lambda number: -number) is None


@pytest.mark.parametrize("value", [np.array([1.5, -2.0], "f4"), np.array([3, 4], "u1"), array("b", [1])])
def test_each_number_of_an_array_is_changed(value: Any) -> None:
    changed: Any = Quantity.map_numbers(value, lambda number: -number)
    assert list(changed) == [-float(number) for number in value]
