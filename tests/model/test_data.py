"""Values of the user's as data: what is plain is seen, and nothing else is asked for anything."""

from __future__ import annotations

import datetime
import math
import sys
from array import array
from collections import deque, namedtuple
from dataclasses import dataclass
from decimal import Decimal
from enum import Enum, IntEnum
from fractions import Fraction
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

from mutabot.model import Kind, Path, Quantity
from mutabot.model.codec import to_json
from mutabot.model.data import UNKNOWN, data_of, fields_of, in_place_of, is_of_numpy
from mutabot.runtime.event_file import json_stand_in

ASKED: list[str] = []


class Touchy:
    """Notes whatever it is asked, and fails."""

    def __getattribute__(self, name: str) -> Any:
        ASKED.append(name)
        raise RuntimeError(name)

    def _fails(self, *_: object) -> Any:
        ASKED.append("an operator")
        raise RuntimeError("an operator")

    __eq__ = __hash__ = __bool__ = __float__ = __int__ = __repr__ = __str__ = __len__ = __iter__ = _fails  # type: ignore[assignment]
    tolist = dtype = shape = property(_fails)


class Metres(float):
    def __float__(self) -> float:
        raise RuntimeError("float")


class Colour(Enum):
    RED = "red"


class Gear(IntEnum):
    FIRST = 1


class Quantitative(np.ndarray):  # type: ignore[type-arg]
    """As quantities with units are that are arrays themselves."""

    def tolist(self) -> Any:
        raise RuntimeError("it has a unit")


Point = namedtuple("Point", "x y")  # as users write it


@dataclass
class Pose:
    x: float
    other: Any = None


@dataclass(slots=True)
class Slotted:
    x: float


NUMBERS = np.array([1.0, 2.0])


@pytest.mark.parametrize(
    ("value", "data"),
    [
        (0.5, 0.5),
        (True, True),
        ("red", "red"),
        (Metres(0.5), 0.5),
        (Decimal("0.25"), 0.25),
        (Fraction(1, 4), 0.25),
        ([Decimal(1), 2], [1.0, 2]),
        (np.array(0.5), np.float64(0.5)),
        (np.array(True), np.True_),
        ([np.array(1), 2], [np.int64(1), 2]),
        (Point(1.0, Decimal(2)), (1.0, 2.0)),
        (Colour.RED, Colour.RED),
        (Gear.FIRST, Gear.FIRST),
        (datetime.timedelta(1), datetime.timedelta(1)),
        (None, None),
    ],
)
def test_plain_values_are_data(value: Any, data: Any) -> None:
    found = data_of(value)
    assert found == data
    assert type(found) is type(data)


@pytest.mark.parametrize("value", [NUMBERS, NUMBERS[0], array("d", [1.0]), [0.1, 0.2], (1, "a"), {"a": 1}])
def test_what_is_data_already_stays_the_very_object(value: Any) -> None:
    assert data_of(value) is value


@pytest.mark.parametrize(
    "make",
    [
        Touchy, lambda: [0.1, Touchy()], lambda: Pose(0.1), object, lambda: NUMBERS.view(Quantitative),
        lambda: Pose, lambda: {"a": [Touchy()]}, lambda: deque([Touchy()]),
        lambda: MappingProxyType({1: Touchy()}),
    ],
)  # fmt: skip
def test_what_else_there_is_is_asked_for_nothing(make: Any) -> None:
    value = make()
    ASKED.clear()
    assert data_of(value) is UNKNOWN
    assert not is_of_numpy(value)
    assert to_json({"value": value}, json_stand_in).startswith(b'{"value":')
    assert ASKED == []


def test_what_holds_itself_is_no_data() -> None:
    numbers: list[Any] = [1.0]
    numbers += [numbers, numbers]
    assert data_of(numbers) is data_of({"all": numbers}) is UNKNOWN


def test_fields_are_read_as_they_are_stored() -> None:
    ASKED.clear()
    other = Touchy()
    found = fields_of(Pose(0.1, other))
    assert found is not None
    assert found["x"] == 0.1
    assert found["other"] is other
    assert fields_of(Slotted(0.2)) == {"x": 0.2}
    assert fields_of(Point(1, 2)) == {"x": 1, "y": 2}
    assert fields_of(other) is None
    assert ASKED == []


@pytest.mark.parametrize(
    ("before", "value", "after"),
    [
        (Decimal("0.5"), -0.25, Decimal("-0.25")),
        (Fraction(1, 2), 0.25, Fraction(1, 4)),
        (Metres(0.5), 0.25, Metres(0.25)),
        (np.float32(0.5), 0.25, np.float32(0.25)),
        (np.int32(5), 0.25, 0.25),
        (5, 0.25, 0.25),
        ([Decimal(1), 2.0], [0.5, 3.0], [Decimal("0.5"), 3.0]),
        (Point(1.0, Decimal(2)), (0.5, 3.0), Point(0.5, Decimal("3.0"))),
        ("red", "blue", "blue"),
        (np.array(2.0), 3.5, np.float64(3.5)),
        (np.array(2.0, "f4"), False, np.float32(0.0)),
        (Fraction(1, 2), math.nan, None),
        # the digits that a floating-point number has no place for
        (Fraction(1, 3), -1 / 3, Fraction(-1, 3)),
        (Fraction(1, 3), 1 / 3, Fraction(1, 3)),
        (Decimal("0.1000000000000000000001"), -0.1, Decimal("-0.1000000000000000000001")),
        ([Fraction(2, 3), 1.0], [-2 / 3, 1.0], [Fraction(-2, 3), 1.0]),
    ],
)
def test_a_new_value_is_of_the_class_of_what_was_there(before: Any, value: Any, after: Any) -> None:
    found = in_place_of(before, value)
    if after is None:  # none of that class can be made of it
        assert found is value
    else:
        assert found == after
        assert type(found) is type(after)
        if isinstance(after, list | tuple):
            assert [type(found_value) for found_value in found] == [
                type(expected_value) for expected_value in after
            ]


class Count(int):
    """An integer of a class of its own."""


@pytest.mark.parametrize("number", [Fraction(10**400), Decimal("sNaN"), 10**400, -(10**4000), Count(10**400)])
def test_an_exact_number_that_is_no_floating_point_number_is_left_alone(number: Any) -> None:
    assert data_of(number) is UNKNOWN
    assert data_of([1, number]) is UNKNOWN


def test_the_largest_integers_that_are_floating_point_numbers_are_data() -> None:
    largest = int(sys.float_info.max)
    assert data_of(largest) == largest
    assert data_of(-largest) == -largest


@pytest.mark.parametrize("number", [Decimal("0.5"), Fraction(1, 2), Metres(0.5)])
def test_a_quantity_is_read_as_a_number_and_written_as_what_was_there(number: Any) -> None:
    quantity = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m")
    pose = Pose(number)
    assert type(quantity.get(pose)) is float
    assert type(quantity.put(pose, 0.25).x) is type(number)
    assert float.__float__(quantity.put(pose, 0.25).x) == 0.25 if isinstance(number, float) else True
    assert pose.x is number
