"""Which values of a quantity are the same for the robot, and which are faults."""

from __future__ import annotations

import math
from array import array
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from mutabot.model import Kind, Mode, Path, Quantity
from mutabot.model.quantity import are_same, changes
from mutabot.model.units import from_rotation_vector, to_euler

YAW_TO = Quantity("yaw", Path("yaw"), Kind.ROTATION, "z", "deg", mode=Mode.TO)
YAW_BY = replace(YAW_TO, mode=Mode.BY)
RADIANS = replace(YAW_TO, unit="rad")
WITHIN = replace(YAW_TO, range=(-180.0, 180.0))
WINDING = replace(YAW_TO, range=(-360.0, 360.0))
JOINT = replace(YAW_TO, axis="j6")
HEADING = Quantity("result", Path(), Kind.ORIENTATION, "z", "deg")
X = Quantity("x", Path("x"), Kind.TRANSLATION, "x", "m", mode=Mode.TO)
X_MM = replace(X, unit="mm")
PRESSURE = Quantity("p", Path("p"), Kind.PRESSURE, unit="bar")
TICKS = Quantity("ticks", Path("ticks"), Kind.COUNT)
STAMP = Quantity("stamp", Path("stamp"), Kind.STAMP)
WXYZ = Quantity("q", Path("q"), Kind.QUATERNION, order="wxyz")
EULER = Quantity("e", Path("e"), Kind.EULER, unit="deg", order="xyz")
ROTVEC = Quantity("r", Path("r"), Kind.ROTATION_VECTOR, unit="rad")
LABEL = Quantity("result", Path(), Kind.LABEL, values=("red", "blue"))

SAME = [
    (YAW_TO, 0, -1.27222e-14),  # whole numbers as well
    (YAW_BY, 0.0, -1.27222e-14),
    (X, 0.1 + 0.2, 0.3),
    (X_MM, 0.0, 2e-10),
    (X, [0.0, 0.3], [1e-16, 0.1 + 0.2]),
    (X, np.array([0.0, 0.3]), np.array([1e-16, 0.1 + 0.2])),
    (X, array("d", [0.3]), array("d", [0.1 + 0.2])),
    (X, math.nan, math.nan),
    (X, math.inf, math.inf),
    (YAW_TO, 180, -180),
    (YAW_TO, 350.0, -10.0),
    (YAW_TO, 90.0, 810.0),
    (RADIANS, math.pi, -math.pi),
    (RADIANS, 3.1416, -3.1416),
    (WITHIN, 180.0, -180.0),
    (YAW_TO, [0.0, 180.0], [0.0, -180.0]),
    (WXYZ, [0.8, 0.6, 0.0, 0.0], [-0.8, -0.6, 0.0, 0.0]),
    (WXYZ, (0.8, 0.6, 0.0, 0.0), np.array([0.8, 0.6, 0.0, 0.0])),
    (EULER, [180.0, 0.0, 180.0], [0.0, 180.0, 0.0]),
    (EULER, [10.0, 20.0, 30.0], [-170.0, 160.0, -150.0]),
    (ROTVEC, [0.0, math.pi, 0.0], [0.0, -math.pi, 0.0]),
    (ROTVEC, [0.0, 0.0, 0.5], [0.0, 0.0, 0.5 - 2.0 * math.pi]),
    (STAMP, 1.7e9, 1.7e9),
    (LABEL, "red", "red"),
]
OTHERS = [
    (YAW_BY, 180, -180),  # another motion
    (YAW_BY, 350.0, -10.0),
    (JOINT, 350.0, -10.0),  # another turn of the joint
    (WINDING, 350.0, -10.0),
    (HEADING, 180.0, -180.0),  # the program may tell them apart
    (YAW_TO, 180.0, -179.0),
    (YAW_TO, 0.0, 0.01),
    (RADIANS, 3.14, -3.14),
    (X, 0.0, 1e-9),
    (X_MM, 0.0, 1e-6),
    (X, 0.5, -0.5),
    (X, [0.0, 0.3], [0.0, 0.3, 0.0]),
    (X, [0.0, 0.3], [0.0, 0.301]),
    (X, math.inf, -math.inf),
    (X, math.nan, 0.0),
    (X, 0.5, None),
    (PRESSURE, 0.0, 1e-9),
    (TICKS, 10**12, 10**12 + 1),
    (STAMP, 1.7e9, 1.7e9 + 0.1),  # a tenth of a second is six thousandths of a millionth of it
    (WXYZ, [0.8, 0.6, 0.0, 0.0], [0.8, -0.6, 0.0, 0.0]),
    (EULER, [10.0, 20.0, 30.0], [30.0, 20.0, 10.0]),
    (ROTVEC, [0.0, 0.5, 0.0], [0.0, -0.5, 0.0]),
    (LABEL, "red", "blue"),
]


@pytest.mark.parametrize(("quantity", "first", "second"), SAME)
def test_the_robot_cannot_distinguish_them(quantity: Quantity, first: Any, second: Any) -> None:
    assert quantity.is_same(first, second)
    assert quantity.is_same(second, first)


@pytest.mark.parametrize(("quantity", "first", "second"), OTHERS)
def test_the_robot_can_distinguish_them(quantity: Quantity, first: Any, second: Any) -> None:
    assert not quantity.is_same(first, second)
    assert not quantity.is_same(second, first)


@pytest.mark.parametrize("order", ["xyz", "ZYX", "zxz"])
def test_a_pose_in_another_writing_is_the_same_pose(order: str) -> None:
    quantity = replace(EULER, order=order, unit="rad")
    angles = to_euler(from_rotation_vector([0.3, -0.7, 1.1]), order)
    first, middle, third = angles
    other = [first + math.pi, (-middle if order == "zxz" else math.pi - middle), third + math.pi]
    assert quantity.is_same(angles, other)


def test_values_of_a_call_are_compared_by_their_quantities() -> None:
    before, after = {"yaw": 180.0, "x": 0.5, "more": 1.0}, {"yaw": -180.0, "x": 0.25, "more": 1.0}
    assert changes((YAW_TO, X), before, after) == {"x": 0.25}
    assert not are_same((YAW_TO, X), before, after)
    assert are_same((YAW_TO, X), before, {**after, "x": 0.5})
    assert not are_same((YAW_TO, X), before, {"yaw": 180.0, "x": 0.5})
    assert changes((YAW_TO, X), {"x": 0.5}, {"x": 0.5, "yaw": 0.0}) == {"yaw": 0.0}
