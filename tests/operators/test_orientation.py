"""Operators on orientations as a whole: what comes out is an orientation, in the form of what went in."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import numpy as np
import pytest

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators import Subject, operator
from mutabot.operators.kinds.readings import disturbed

KINDS = {
    "rotation_vector": (Quantity("o", Path("o"), Kind.ROTATION_VECTOR, unit="deg"), [10.0, -20.0, 30.0]),
    "quaternion": (Quantity("o", Path("o"), Kind.QUATERNION, order="xyzw"), [0.0, 0.6, 0.0, 0.8]),
    "euler": (Quantity("o", Path("o"), Kind.EULER, unit="deg", order="ZYX"), [10.0, 20.0, 30.0]),
}


def turned(quantity: Quantity, value: Any) -> Any:
    found = quantity.orientation(value)
    assert found is not None
    return found


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("form", [list, tuple, np.array])
def test_the_other_way_is_the_inverse_rotation_in_the_same_form(name: str, form: Any) -> None:
    quantity, numbers = KINDS[name]
    value = form(numbers)
    found = quantity.inverted(value)
    assert type(found) is type(value)
    assert turned(quantity, found).distance(turned(quantity, value).inverse) < 1e-9
    assert list(value) == numbers


def test_a_tool_that_points_down_is_its_own_inverse_however_pi_is_written() -> None:
    quantity = Quantity("o", Path("o"), Kind.EULER, unit="rad", order="XYZ")
    for value in ([3.14159, 0.0, 0.0], [3.1416, 0.0002, 0.0], [math.pi, 0.0, 0.0]):
        assert quantity.inverted(value) is value
    assert quantity.inverted([3.13, 0.0, 0.0]) is not None
    assert quantity.inverted([3.13, 0.0, 0.0]) != [3.13, 0.0, 0.0]


@pytest.mark.parametrize("name", KINDS)
def test_noise_is_a_small_turn_by_its_deviation(name: str) -> None:
    quantity, value = KINDS[name]
    random, deviation = Random(1), quantity.from_unit(0.02, "rad")
    angles = [
        turned(quantity, value).distance(turned(quantity, disturbed(quantity, value, random, deviation)))
        for _ in range(500)
    ]
    # three parts of this deviation each: the mean square of the angle is 3 σ²
    assert math.sqrt(sum(angle**2 for angle in angles) / 500) == pytest.approx(0.02 * math.sqrt(3), rel=0.1)


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("value", [None, "up", [1.0, 2.0], [0.0, 0.0, 0.0, 0.0, 0.0]])
def test_what_is_no_orientation_is_left_alone(name: str, value: Any) -> None:
    assert KINDS[name][0].inverted(value) is None
    assert disturbed(KINDS[name][0], value, Random(1), 0.1) is None


def test_half_a_turn_stays_what_it_is() -> None:
    quantity, value = KINDS["rotation_vector"][0], [0.0, 180.0, 0.0]
    assert quantity.inverted(value) is value


@pytest.mark.parametrize("kind", [quantity.kind for quantity, _ in KINDS.values()])
def test_by_to_makes_no_mutant_of_a_whole_orientation(kind: Kind) -> None:
    quantity = Quantity("o", Path("o"), kind, unit="deg", mode=Mode.TO)
    operation = Operation("robot:Arm.turn", (quantity,), current="robot:Arm.tool")
    assert list(operator("by-to").subjects(Subject(operation))) == []
    assert len(list(operator("reverse").subjects(Subject(operation)))) == 1
