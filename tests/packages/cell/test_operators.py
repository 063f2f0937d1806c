"""What the catalogue does to frames and orientations, against rotation matrices."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import numpy as np
import pytest

from mutabot.model import Call, Kind, Mode, Operation, Path, Quantity
from mutabot.model.quantity import Value
from mutabot.operators import Subject, operator
from mutabot.operators.middleware import rehearse
from mutabot_cell.geometry import rotation_from_euler

AXES = "xyz"
RANDOM = Random(1)
ANGLES = [[RANDOM.uniform(-170, 170) for _ in AXES] for _ in range(10)]


def quantity(
    name: str, kind: Kind, axis: str | None = None, unit: str | None = None, **more: Any
) -> Quantity:
    return Quantity(name, Path(name), kind, axis, unit, **more)


def written(name: str, subject: Subject, values: dict[str, Value], **current: float) -> dict[str, Value]:
    """What the robot hears instead of these values."""
    rule = operator(name)
    passage = rehearse(
        rule.middleware(subject, Random(1)), Call(subject.operation, None, values), {}, current=current,
        operator=name,
    )  # fmt: skip
    return dict(passage.performed[0].values)


@pytest.mark.parametrize("angles", ANGLES)
@pytest.mark.parametrize("frame", ["base", "tool"])
def test_a_move_in_the_other_frame_is_turned_as_the_tool_is(frame: str, angles: list[float]) -> None:
    moves = tuple(quantity(axis, Kind.TRANSLATION, axis, "m", frame=frame, mode=Mode.BY) for axis in AXES)
    where = Operation("robot:Arm.move", moves, current="robot:Arm.pose")
    move = dict(zip(AXES, (0.1, -0.2, 0.3), strict=True))
    told = dict(zip(("theta_x", "theta_y", "theta_z"), angles, strict=True))
    turned = written("base-for-tool", Subject(where, quantity=moves[0]), move, **told)
    matrix = rotation_from_euler(*angles)
    expected = (matrix if frame == "base" else matrix.T) @ np.array([*move.values()])
    assert list(turned.values()) == pytest.approx(expected.tolist())


def test_a_move_in_the_other_frame_stays_within_the_range_of_each_axis() -> None:
    moves = tuple(
        quantity(axis, Kind.TRANSLATION, axis, "m", frame="base", mode=Mode.BY, range=(-0.1, 0.5))
        for axis in AXES
    )
    where = Operation("robot:Arm.move", moves, current="robot:Arm.pose")
    move = dict(zip(AXES, (0.1, 0.2, 0.3), strict=True))
    told = {"theta_x": 10.0, "theta_y": 20.0, "theta_z": 90.0}
    assert rotation_from_euler(*told.values())[0] @ np.array([*move.values()]) < -0.1
    assert written("base-for-tool", Subject(where, quantity=moves[0]), move, **told) == move


@pytest.mark.parametrize("angles", ANGLES)
def test_a_left_handed_pose_is_mirrored_whichever_way_its_orientation_is_written(angles: list[float]) -> None:
    mirror = np.diag([1.0, -1.0, 1.0])
    expected = mirror @ rotation_from_euler(*angles) @ mirror
    y = quantity("y", Kind.TRANSLATION, "y", "m", mode=Mode.TO)
    thetas = [quantity(f"theta_{axis}", Kind.ROTATION, axis, "deg", mode=Mode.TO) for axis in AXES]
    rpy = quantity("rpy", Kind.EULER, None, "deg", order="xyz")
    parts = Operation("robot:Arm.move_to", (y, *thetas))
    whole = Operation("robot:Arm.put", (y, rpy))
    values = {"y": 0.2, **{theta.name: angle for theta, angle in zip(thetas, angles, strict=True)}}
    found = written("left-handed", Subject(parts, quantity=y), values)
    assert found.pop("y") == -0.2
    assert rotation_from_euler(*found.values()) == pytest.approx(expected)
    found = written("left-handed", Subject(whole, quantity=y), {"y": 0.2, "rpy": angles})
    assert rotation_from_euler(*found["rpy"]) == pytest.approx(expected)


@pytest.mark.parametrize("angles", ANGLES)
def test_euler_angles_in_the_reverse_order_are_the_product_of_the_same_turns(angles: list[float]) -> None:
    rpy = quantity("rpy", Kind.EULER, None, "deg", order="xyz")
    where = Operation("robot:Arm.orient", (rpy,))
    found = written("euler-order", Subject(where, quantity=rpy), {"rpy": angles})["rpy"]
    a, b, c = angles
    turns = rotation_from_euler(a, 0, 0) @ rotation_from_euler(0, b, 0) @ rotation_from_euler(0, 0, c)
    assert rotation_from_euler(*found) == pytest.approx(turns)


@pytest.mark.parametrize("order", ["wxyz", "xyzw"])
def test_a_quaternion_in_the_other_order_and_back_is_the_same(order: str) -> None:
    back = "xyzw" if order == "wxyz" else "wxyz"
    numbers = [0.1, -0.5, 0.7, math.sqrt(1 - 0.75)]
    for written_order in (order, back):
        turned = quantity("turned", Kind.QUATERNION, order=written_order)
        subject = Subject(Operation("robot:Arm.orient", (turned,)), quantity=turned)
        numbers = written("quaternion-order", subject, {"turned": numbers})["turned"]
    assert numbers == pytest.approx([0.1, -0.5, 0.7, 0.5])


@pytest.mark.parametrize("name", ["quaternion-order", "quaternion-sign"])
def test_a_quaternion_stays_one_of_unit_length(name: str) -> None:
    turned = quantity("turned", Kind.QUATERNION, order="wxyz")
    where = Operation("robot:Arm.orient", (turned,))
    for subject in operator(name).subjects(Subject(where)):
        found = written(name, subject, {"turned": [0.1, -0.5, 0.7, 0.5]})["turned"]
        assert math.hypot(*found) == pytest.approx(1.0)
        assert found != [0.1, -0.5, 0.7, 0.5]
