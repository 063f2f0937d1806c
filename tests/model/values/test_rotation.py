"""Orientations, compared with scipy's."""

from __future__ import annotations

import math
from itertools import product as combinations
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mutabot.model.units import Quaternion, apart, is_euler_order, to_quaternion, to_values

ORDERS = [
    "".join(axes) for axes in combinations("xyz", repeat=3) if axes[0] != axes[1] and axes[1] != axes[2]
]
ORDERS += [order.upper() for order in ORDERS]
ROTATIONS = Rotation.random(5, random_state=1)


def same(value: float) -> float:
    return value


def read(kind: str, order: str | None, values: Any) -> Any:
    return to_quaternion(list(values), kind, order, same)


@pytest.mark.parametrize("order", ORDERS)
def test_euler_angles_are_those_of_scipy(order: str) -> None:
    for rotation in ROTATIONS:
        angles = rotation.as_euler(order)
        found = read("euler", order, angles)
        assert found.distance(Quaternion(*rotation.as_quat(scalar_first=True))) < 1e-9
        assert to_values(found, "euler", order, same) == pytest.approx(angles, abs=1e-9)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("middle", [0.0, math.pi / 2, -math.pi / 2, math.pi])
def test_euler_angles_lead_back_where_two_axes_fall_together(order: str, middle: float) -> None:
    before = read("euler", order, [0.4, middle, -0.3])
    after = read("euler", order, to_values(before, "euler", order, same))
    assert before.distance(after) < 1e-6


def test_rotation_vectors_are_those_of_scipy() -> None:
    for rotation in ROTATIONS:
        vector = rotation.as_rotvec()
        found = read("rotation_vector", None, vector)
        assert to_values(found, "rotation_vector", None, same) == pytest.approx(vector, abs=1e-9)


@pytest.mark.parametrize("order", ["wxyz", "xyzw"])
def test_quaternions_are_read_in_their_order_and_of_any_length(order: str) -> None:
    rotation = ROTATIONS[0]
    parts = rotation.as_quat(scalar_first=order == "wxyz")
    found = read("quaternion", order, 2.5 * parts)
    assert found.distance(Quaternion(*rotation.as_quat(scalar_first=True))) < 1e-9
    assert to_values(found, "quaternion", order, same) == pytest.approx(parts)


def test_the_distance_is_the_angle_between_two_orientations() -> None:
    first, second = ROTATIONS[0], ROTATIONS[1]
    found = read("quaternion", "xyzw", first.as_quat()).distance(read("quaternion", "xyzw", second.as_quat()))
    assert found == pytest.approx((first.inv() * second).magnitude())


def test_half_a_turn_either_way_is_the_same_orientation() -> None:
    first, second = (read("rotation_vector", None, [0.0, angle, 0.0]) for angle in (math.pi, -math.pi))
    assert first.distance(second) < 1e-9
    assert first.distance(first.inverse) < 1e-9


def test_a_tiny_distance_keeps_its_digits() -> None:
    first, second = (read("rotation_vector", None, [0.0, 0.0, angle]) for angle in (0.5, 0.5 + 1e-9))
    assert first.distance(second) == pytest.approx(1e-9, rel=1e-3)


@pytest.mark.parametrize("values", [[1.0, 2.0], [0.0] * 4, "abcd", [1, 2, 3, math.nan], None, [1, 2, 3, "w"]])
def test_what_is_no_orientation_is_none(values: Any) -> None:
    assert to_quaternion(values, "quaternion", "wxyz", same) is None


def test_arrays_are_taken() -> None:
    assert to_quaternion(np.array([0.0, 0.0, 0.0, 1.0]), "quaternion", "xyzw", same) == (1.0, 0.0, 0.0, 0.0)


def test_angles_are_compared_modulo_a_turn() -> None:
    assert apart(179.9, -179.9, 360.0) == pytest.approx(0.2)
    assert apart(10.0, 370.0, 360.0) == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("xyz", True),
        ("ZYX", True),
        ("zxz", True),
        ("xxy", False),
        ("xYz", False),
        ("xy", False),
        ("abc", False),
    ],
)
def test_axes_of_euler_angles(text: str, expected: bool) -> None:
    assert is_euler_order(text) is expected
