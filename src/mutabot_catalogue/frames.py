"""Operators that confuse frames, axes, joints, tools and orientations with others."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations
from typing import Any, ClassVar

from mutabot.api.faults import Context, Example, Need, Subject, Unchanged, ValueOperator
from mutabot.api.values import Kind, Mode, Operation, Path, Quantity

from ._examples import MOVE_TO
from .values import CATALOGUE, Exchange, is_alike, like

_BASE, _TOOL = "base", "tool"
_AXES = "xyz"
#: how the tool is turned in the base's frame: by three angles, one after the other about axes that stay
_TURNS = tuple(
    Quantity(f"theta_{axis}", Path(), Kind.ROTATION, axis, "deg", _BASE, Mode.TO) for axis in _AXES
)
_TOOL_TURNED = Quantity("", Path(), Kind.EULER, unit="deg", order="xyz")
_MOVES = tuple(Quantity(axis, Path(axis), Kind.TRANSLATION, axis, "m", _BASE, Mode.BY) for axis in _AXES)
_MOVE_BY = Operation("robot:Arm.move_by", _MOVES, current="robot:Arm.tool_pose")
_DOWN = {"theta_x": 180.0, "theta_y": 0.0, "theta_z": 90.0}
_SET = tuple(
    Quantity(f"joints[{index}]", Path("joints"), Kind.ROTATION, f"j{index + 1}", "deg", mode=Mode.TO)
    for index in range(3)
)
_SET_JOINTS = Operation("robot:Arm.move_joints", _SET)
_READ = tuple(Quantity(f"[{index}]", Path(), Kind.ANGLE, f"j{index + 1}", "deg") for index in range(3))
_READ_JOINTS = Operation("robot:Arm.joints", result=_READ, command=False)
_J6 = Quantity("joints[5]", Path("joints"), Kind.ROTATION, "j6", "deg", mode=Mode.TO, range=(-360.0, 360.0))
_SET_J6 = Operation("robot:Arm.move_joints", (_J6,))
_YAW = Quantity("yaw", Path("yaw"), Kind.ROTATION, "z", "deg", "base", Mode.TO)
_TURNED = Quantity("turned", Path("turned"), Kind.QUATERNION, order="wxyz")
_POSE = Operation("robot:Arm.move_to", (MOVE_TO.arguments[1], _YAW))
_PUT = Operation("robot:Arm.put", (MOVE_TO.arguments[1], _TURNED))
#: 12 cm of gripper that looks down
_TIP = Quantity("z", Path("z"), Kind.TRANSLATION, "z", "m", "base", Mode.TO, range=(0.0, 0.6), tcp=-0.12)
_MOVE_TIP = Operation("robot:Arm.move_to", (_TIP,))


def _joints(quantities: tuple[Quantity, ...], *angles: float) -> dict[str, float]:
    return {quantity.name: angle for quantity, angle in zip(quantities, angles, strict=True)}


class AxisSwap(Exchange):
    """Two components of a motion are exchanged: along y instead of x.

    Where: commands that write two of the axes x, y, z of one translation or rotation.

    Stands for: A wrong axis: {frames}.
    """

    name = "axis-swap"
    is_common = True
    examples = (
        Example.changed(MOVE_TO, {"x": 0.4, "y": 0.1}, {"x": 0.1, "y": 0.4}, "y"),
        Example.unchanged(MOVE_TO, {"x": 0.2, "y": 0.2}, "both are the same", "y"),
        Example.unchanged(MOVE_TO, {"x": 0.2}, "the call gives no y", "y"),
    )

    def pairs(self, whole: Subject) -> Iterator[tuple[Quantity, Quantity]]:
        for first, second in combinations(whole.written, 2):
            is_motion = first.kind in (Kind.TRANSLATION, Kind.ROTATION) and {first.axis, second.axis} <= {
                *_AXES
            }
            if is_motion and first.axis != second.axis and is_alike(first, second):
                yield first, second


class JointOrder(Exchange):
    """The angles of the first and the third joint are exchanged, as if joints were sorted by name.

    Where: written and read angles of the joints j1 and j3.

    Stands for: Joints in another order, as in joint states that are sorted by name: {frames}.
    """

    name = "joint-order"
    examples = (
        Example.changed(_SET_JOINTS, _joints(_SET, 10, 20, 30), _joints(_SET, 30, 20, 10), "joints[2]"),
        Example.changed(
            _READ_JOINTS, _joints(_READ, 10.0, 20.0, 30.0), _joints(_READ, 30.0, 20.0, 10.0), "[2]"
        ),
        Example.unchanged(_SET_JOINTS, _joints(_SET, 0, 20, 0), "both are the same", "joints[2]"),
    )

    def pairs(self, whole: Subject) -> Iterator[tuple[Quantity, Quantity]]:
        for side in (whole.written, whole.read):
            for quantity in side:
                is_first = quantity.axis == "j1" and quantity.kind in (Kind.ROTATION, Kind.ANGLE)
                yield from (
                    (quantity, other)
                    for other in side
                    if is_first and other.axis == "j3" and is_alike(quantity, other)
                )


class LeftHanded(ValueOperator):
    """A pose is taken as left-handed: y and the turns about x and z are negated.

    Where: written and read poses with y and an orientation beside it; for y alone it is a wrong sign.

    Stands for: Frames of the other handedness, as of game engines: {frames}.
    """

    name = "left-handed"
    family = CATALOGUE
    examples = (
        Example.changed(_POSE, {"y": 0.2, "yaw": 30.0}, {"y": -0.2, "yaw": -30.0}),
        Example.changed(
            _PUT, {"y": 0.2, "turned": [0.8, 0.0, 0.0, 0.6]}, {"y": -0.2, "turned": [0.8, 0.0, 0.0, -0.6]}
        ),
        Example.unchanged(_POSE, {"y": 0.0, "yaw": 0.0}, "a mirror changes nothing here"),
    )

    def subjects(self, whole: Subject) -> Iterator[Subject]:
        for side in (whole.written, whole.read):
            for quantity in side:
                is_place = quantity.kind in (Kind.TRANSLATION, Kind.POSITION)
                if is_place and quantity.axis == "y" and any(map(_turns, side)):
                    yield replace(whole, quantity=quantity)

    async def changes(self, values: Mapping[str, Any], context: Context) -> Mapping[str, Any]:
        quantity = context.quantity
        value = context.subject.given(values, quantity.name)
        found = {quantity.name: quantity.map_numbers(value, _negative)}
        for side_quantity in context.subject.side:
            if _turns(side_quantity) and side_quantity.name in values:
                found[side_quantity.name] = _mirrored(side_quantity, values[side_quantity.name])
        return found

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        verb = "" if subject.is_written else "reads "
        name = subject.required_quantity.label
        return f"{verb}the pose mirrored: {name} and the turns about x and z negated"


def _turns(quantity: Quantity) -> bool:
    """Return whether a quantity is an orientation, or a part of one, that a mirror changes."""
    is_angle = quantity.kind in (Kind.ROTATION, Kind.ORIENTATION)
    return quantity.is_whole or (is_angle and quantity.axis in ("x", "z"))


def _negative(number: float) -> float:
    return -number if number else number


def _mirrored(quantity: Quantity, value: Any) -> Any | None:
    if not quantity.is_whole:
        return quantity.map_numbers(value, _negative)
    return quantity.rotated(value, lambda quaternion: quaternion._replace(x=-quaternion.x, z=-quaternion.z))


class BaseForTool(ValueOperator):
    """A relative move in the base's frame is executed along the tool's axes, or the reverse.

    Where: relative translations along x, y and z in a frame named base or tool, with a current that reads the
    three angles of the tool, about axes that stay, in the base's frame.

    Stands for: A wrong or missing transform: {frames}.
    """

    name = "base-for-tool"
    family = CATALOGUE
    needs = frozenset({Need.PLACE})
    examples = (
        Example.changed(
            _MOVE_BY, {"x": 0.1, "y": 0.0, "z": 0.2}, {"x": 0.0, "y": 0.1, "z": -0.2}, current=_DOWN
        ),
        Example.unchanged(
            _MOVE_BY,
            {"x": 0.1, "y": 0.0, "z": 0.2},
            "both frames have the same axes",
            current=dict.fromkeys(_DOWN, 0.0),
        ),
        Example.unchanged(_MOVE_BY, 0.1, "the call gives no y", current=_DOWN),
    )

    def subjects(self, whole: Subject) -> Iterator[Subject]:
        moved = _moved(whole)
        if whole.current is not None and moved:
            yield replace(whole, quantity=moved[0])

    async def changes(self, values: Mapping[str, Any], context: Context) -> Mapping[str, Any]:
        before: dict[str, Any] = {
            quantity.name: values.get(quantity.name) for quantity in _moved(context.subject)
        }
        if not all(map(context.quantity.is_scalar, before.values())):
            raise Unchanged(context.subject.why_missing)
        asked = (
            Quantity(f"theta_{axis}", Path(), Kind.ROTATION, axis, "deg", _BASE, Mode.TO) for axis in _AXES
        )
        tool = _TOOL_TURNED.orientation([await context.call.current(quantity) for quantity in asked])
        if tool is None:
            raise Unchanged("the orientation of the tool is not known")
        turn = tool if context.quantity.frame == _BASE else tool.inverse
        vector: list[float] = [*before.values()]
        least = 1e-12 * max(abs(part) for part in vector)  # less is rounding
        parts = (0.0 if abs(part) < least else part for part in turn.rotated(vector))
        return dict(zip(before, parts, strict=True))

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        frame = subject.required_quantity.frame
        names = ", ".join(quantity.label for quantity in _moved(subject))
        return f"{names} along the axes of the {_TOOL if frame == _BASE else _BASE}"


def _moved(subject: Subject) -> list[Quantity]:
    """Return the relative translation along the three axes of one frame, in order."""
    found = {
        (quantity.frame, quantity.axis): quantity
        for quantity in subject.written
        if quantity.kind is Kind.TRANSLATION and quantity.mode is Mode.BY
    }
    for frame in (_BASE, _TOOL):
        moved = [found[frame, axis] for axis in _AXES if (frame, axis) in found]
        if len(moved) == len(_AXES):
            return moved
    return []


class _WrongTcp(ValueOperator):
    """Moves a target along the tool's offset.

    Where: target positions whose vocabulary says how far the tool reaches: tcp.

    Class attributes:
        sign: which way, as a share of the offset.

    Stands for: A tool that is not set up, or set up in two places: {frames}.
    """

    family = CATALOGUE
    of_read = False
    sign: ClassVar[float]

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return bool(quantity.tcp)

    def change(self, value: Any, context: Context) -> Any | None:
        offset = self.sign * (context.quantity.tcp or 0.0)
        return context.quantity.map_numbers(value, lambda number: number + offset)


class TcpMissing(_WrongTcp):
    """The offset of the tool centre point (`tcp`) is missing: the flange goes where the tip should."""

    name = "tcp-missing"
    sign = 1.0
    examples = (
        Example.changed(_MOVE_TIP, 0.3, 0.18),
        Example.unchanged(_MOVE_TIP, 0.05, "it would be below the range [0, 0.6]"),
    )


class TcpDoubled(_WrongTcp):
    """The offset of the tool centre point (`tcp`) is counted twice."""

    name = "tcp-doubled"
    sign = -1.0
    examples = (
        Example.changed(_MOVE_TIP, 0.3, 0.42),
        Example.unchanged(_MOVE_TIP, 0.5, "it would be above the range [0, 0.6]"),
    )


class JointTurn(ValueOperator):
    """The target of a joint is off by a full turn: the same pose, by another way.

    Where: absolute angles of joints: rotation with an axis j1 … and mode to.

    Stands for: Angles that wrap around at ±180° or 360°: {frames}.
    """

    name = "joint-turn"
    family = CATALOGUE
    of_read = False
    variants: ClassVar[Mapping[str, float]] = {"+": 1.0, "-": -1.0}
    examples = (
        Example.changed(_SET_J6, 170, -190, "-"),
        Example.unchanged(_SET_J6, 170, "530° is out of the joint's range", "+"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        is_joint = quantity.axis is not None and quantity.axis.startswith("j")
        return is_joint and quantity.kind is Kind.ROTATION and quantity.mode is Mode.TO

    def change(self, value: Any, context: Context) -> Any | None:
        quantity = context.quantity
        turn = 360.0 if quantity.unit == "deg" else quantity.from_unit(2.0 * math.pi, "rad")
        return quantity.map_numbers(value, lambda number: like(number, number + context.option * turn))


_RPY = Operation.writing("robot:Arm.orient", "rpy", Kind.EULER, unit="deg", order="xyz")
_ORIENT = Operation.writing("robot:Arm.orient", "turned", Kind.QUATERNION, order="wxyz")
_LOOK = Operation.reading("camera:orientation", Kind.QUATERNION, order="xyzw")


class _OtherNumbers(ValueOperator):
    """Replaces the numbers of an orientation by others."""

    family = CATALOGUE

    @abstractmethod
    def numbers(self, numbers: list[float], context: Context) -> list[float]:
        """Return the other numbers."""

    def change(self, value: Any, context: Context) -> Any | None:
        quantity = context.quantity
        if quantity.orientation(value) is None:
            raise Unchanged("its value is not an orientation")
        numbers = self.numbers([float(part) for part in value], context)
        if quantity.orientation(numbers) is None or quantity.is_same(value, numbers):
            raise Unchanged("it would be the same orientation")
        parts = iter(numbers)
        return quantity.map_numbers(value, lambda _: next(parts) + 0.0)  # no −0


class EulerOrder(_OtherNumbers):
    """Euler angles are applied in the reverse order: axes that stay are taken for axes that turn along.

    Where: written and read quantities of kind euler.

    Stands for: Two conventions of Euler angles: {frames}.
    """

    name = "euler-order"
    kinds = frozenset({Kind.EULER})
    examples = (
        Example.changed(_RPY, [45.0, 0.0, 90.0], [0.0, -45.0, 90.0]),
        Example.unchanged(_RPY, [0.0, 0.0, 90.0], "a turn about one axis alone has no order"),
    )

    def numbers(self, numbers: list[float], context: Context) -> list[float]:
        quantity = context.quantity
        other = replace(quantity, order=(quantity.order or "").swapcase()).orientation(numbers)
        return numbers if other is None else quantity.numbers(other)


class QuaternionOrder(_OtherNumbers):
    """A quaternion's scalar part is taken to be at the other end: xyzw for wxyz, and back.

    Where: written and read quantities of kind quaternion.

    Stands for: Libraries that order quaternions in two ways: {frames}.
    """

    name = "quaternion-order"
    kinds = frozenset({Kind.QUATERNION})
    examples = (
        Example.changed(_ORIENT, [0.8, 0.6, 0.0, 0.0], [0.0, 0.8, 0.6, 0.0]),
        Example.changed(_LOOK, [0.0, 0.0, 0.6, 0.8], [0.0, 0.6, 0.8, 0.0]),
        Example.unchanged(_ORIENT, [0.5, 0.5, 0.5, 0.5], "all parts are equal, so their order has no effect"),
    )

    def numbers(self, numbers: list[float], context: Context) -> list[float]:
        is_scalar_first = context.quantity.order != "xyzw"
        return [numbers[-1], *numbers[:-1]] if is_scalar_first else [*numbers[1:], numbers[0]]


class QuaternionSign(_OtherNumbers):
    """One part of a quaternion's vector has the wrong sign.

    Where: written and read quantities of kind quaternion.

    Stands for: A wrong sign: {signs}.
    """

    name = "quaternion-sign"
    kinds = frozenset({Kind.QUATERNION})
    variants: ClassVar[dict[str, str]] = {part: part for part in "xyz"}
    examples = (
        Example.changed(_ORIENT, [0.8, 0.48, 0.36, 0.0], [0.8, 0.48, -0.36, 0.0], "y"),
        Example.unchanged(_ORIENT, [0.0, 1.0, 0.0, 0.0], "half a turn the other way is the same", "x"),
        Example.unchanged(_ORIENT, [0.8, 0.48, 0.36, 0.0], "a zero has no sign", "z"),
    )

    def numbers(self, numbers: list[float], context: Context) -> list[float]:
        order = context.quantity.order or "wxyz"
        named = zip(order, numbers, strict=True)
        return [-number if part == context.option else number for part, number in named]
