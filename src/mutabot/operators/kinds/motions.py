"""Operators on motions: wrong direction, and relative amounts mistaken for absolute targets."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

from mutabot.model import Kind, Mode, Operation, Path, Quantity, Unchanged
from mutabot.model.quantity import READING_OF, Value
from mutabot.operators.examples import MOVE_BY, MOVE_TO
from mutabot.operators.operator import Context, Example, Need, Subject
from mutabot.operators.value import ValueOperator

_PATH = Path.parse("message.pose.x", rooted=True)
_GOAL = Quantity("pose.x", _PATH, Kind.TRANSLATION, "x", "m", mode=Mode.TO, relative=True)
_HIDDEN = Operation("publish /arm/goal", (_GOAL,), current="receive /arm/pose")
_MOVE = Operation(
    "robot:Arm.move_by",
    (
        Quantity("dy", Path("dy"), Kind.TRANSLATION, "y", "m", "base", Mode.BY),
        Quantity("yaw", Path("yaw"), Kind.ROTATION, "z", "deg", "base", Mode.BY),
    ),
)
_TURN = Quantity("angle", Path("angle"), Kind.ROTATION, "z", "deg", None, Mode.TO, range=(0.0, 360.0))
_TURN_TO = Operation("robot:Arm.turn_to", (_TURN,))
_FACE = Operation("robot:Arm.face", (replace(_TURN, range=None),))
_PUSH = Quantity("push", Path("push"), Kind.TRANSLATION, "x", "m", None, Mode.BY, range=(-1.0, 1.0))
_STEP = Operation("env:Env.step", (_PUSH,))
_CLIPPED = Operation("env:Env.step", (replace(_PUSH, clip=(-1.0, 1.0)),))
_ORIENT = Operation.writing("robot:Arm.orient", "rotation", Kind.ROTATION_VECTOR, unit="rad")
_LIFT = Quantity("z", Path("z"), Kind.TRANSLATION, "z", "m", "base", Mode.TO, range=(0.0, 0.5))
_LIFT_TO = Operation("robot:Arm.lift_to", (_LIFT,))
_AHEAD = Quantity("linear.x", Path.parse("message.linear.x", rooted=True), Kind.SPEED, "x", "m/s")
_DRIVE = Operation("publish /cmd_vel", (_AHEAD,))
_GO = Operation.writing("base:Base.go", "speed", Kind.SPEED, unit="m/s", range=(-0.2, 1.0))
_X = MOVE_TO.arguments[0]
_BY = replace(MOVE_BY, current="robot:Arm.tool_pose")
_TO = replace(MOVE_TO, arguments=(_X,), current="robot:Arm.tool_pose")
_NEAR = replace(_TO, arguments=(replace(_X, range=(0.0, 0.6)),))
#: kinds that may be a motion with a direction, or only its magnitude
_EITHER = frozenset({Kind.SPEED, Kind.RATIO})
_COMPONENTS = frozenset({"x", "y", "z"})


class Reverse(ValueOperator):
    """A translation, rotation or speed goes the other way: one component is negated; an orientation as a
    whole is inverted. An angle limited to a full turn stays within it.

    Where: written translations, rotations, orientations as a whole, and speeds and ratios with a direction.

    Published: 1. rotate left by θ → rotate right by θ; 2. rotate right by θ → rotate left by θ; 3.
    translate forward by δ → translate backwards by δ; 4. translate backwards by δ → translate forward by
    δ
    """

    name = "reverse"
    is_common = True
    of_read = False
    examples = (
        Example.changed(_MOVE, {"dy": 0.2, "yaw": 0.0}, {"dy": -0.2, "yaw": 0.0}),
        Example.changed(_MOVE, -0.9, 0.9),
        Example.changed(_MOVE, {"dy": 0.0, "yaw": 80}, {"dy": 0.0, "yaw": -80}, quantity="yaw"),
        Example.changed(_MOVE, [0.1, -0.2], [-0.1, 0.2]),
        Example.changed(_TURN_TO, 90, 270),
        Example.changed(_ORIENT, [0.0, 0.5, 0.0], [0.0, -0.5, 0.0]),
        Example.changed(_CLIPPED, 1.7, -1.7),
        Example.unchanged(_STEP, 1.7, "−1.7 m is outside the range [−1, 1]"),
        Example.unchanged(_ORIENT, [0.0, math.pi, 0.0], "half a turn the other way is the same orientation"),
        Example.unchanged(_FACE, 180, "the targets 180 and −180 degrees are the same"),
        Example.changed(_HIDDEN, 0.5, 0.1, current={"pose.x": 0.3}),
        Example.unchanged(_HIDDEN, 0.5, "the target is where the robot is", current={"pose.x": 0.5}),
        Example.changed(_DRIVE, 0.4, -0.4),
        Example.unchanged(_GO, 0.5, "−0.5 m/s is outside the range [−0.2, 1]"),
        Example.unchanged(_MOVE, 0.0, "a zero has no other way"),
        Example.unchanged(_MOVE, {"yaw": 80}, "the call does not give this component"),
        Example.unchanged(_LIFT_TO, 0.3, "−0.3 m is outside the allowed range"),
    )

    def needs_of(self, subject: Subject) -> frozenset[Need]:
        quantity = subject.required_quantity
        found = {Need.PLACE} if quantity.relative else set()
        if quantity.kind in _EITHER and has_direction(quantity) is None:
            found.add(Need.SIGN)
        return frozenset(found)

    async def changes(self, values: Mapping[str, Value], context: Context) -> Mapping[str, Value]:
        if not context.quantity.relative:
            return await super().changes(values, context)
        value, here = await _value_and_place(values, context)
        return {context.quantity.name: _within_turn(context.quantity, 2.0 * here - value)}

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = subject.required_quantity
        if not quantity.relative:
            return super().describe(subject, before, after)
        return f"{quantity.label} {quantity.text(before)} → as far to the other side of where it is"

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        if quantity.kind in _EITHER:
            return has_direction(quantity) is not False
        return quantity.kind in (Kind.TRANSLATION, Kind.ROTATION) or quantity.is_whole

    def change(self, value: Value, context: Context) -> Value | None:
        quantity = context.quantity
        if quantity.is_whole:
            return quantity.inverted(value)
        return quantity.map_numbers(value, lambda number: _within_turn(quantity, -number))


class ByTo(ValueOperator):
    """A relative amount is taken for an absolute target, or an absolute target for a relative amount.

    Where: written translations and rotations whose operation has a current that reads them.

    Published: 5. translate forward by δ → translate forward *to* δ; 6. translate backwards by δ →
    translate backwards *to* δ
    """

    name = "by-to"
    needs = frozenset({Need.PLACE})
    examples = (
        Example.changed(_BY, 0.5, 0.25, current={"dx": 0.25}),
        Example.changed(_BY, -0.5, -0.75, current={"dx": 0.25}),
        Example.changed(_TO, 0.5, 0.75, current={"x": 0.25}),
        Example.unchanged(_BY, 0.5, "by and to agree at zero", current={"dx": 0.0}),
        Example.changed(_HIDDEN, 0.5, 0.2, current={"pose.x": 0.3}),
        Example.unchanged(_NEAR, 0.5, "0.75 is out of range", current={"x": 0.25}),
    )

    def subjects(self, whole: Subject) -> Iterable[Subject]:
        moved = whole.written if whole.current is not None else ()
        return [replace(whole, quantity=quantity) for quantity in moved if quantity.kind in READING_OF]

    async def changes(self, values: Mapping[str, Value], context: Context) -> Mapping[str, Value]:
        quantity = context.quantity
        value, here = await _value_and_place(values, context)
        # the relative move that is hidden in an absolute target is that target less the place
        return {
            quantity.name: value - here if quantity.mode is Mode.BY or quantity.relative else value + here
        }

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = subject.required_quantity
        if quantity.relative:
            return f"{quantity.label} {quantity.text(before)} → the change alone, taken for the target"
        was, becomes = ("by", "to") if quantity.mode is Mode.BY else ("to", "by")
        amount = quantity.text(before)
        return f"{quantity.label} {was} {amount} → {becomes} {amount}"


async def _value_and_place(values: Mapping[str, Value], context: Context) -> tuple[float, float]:
    """Return the value of the call, and the robot's position. Raises Unchanged."""
    quantity, value = context.quantity, values.get(context.quantity.name)
    if value is None or not quantity.is_scalar(value):
        raise Unchanged(context.subject.why_missing)
    if quantity.mode is Mode.BY and value == 0:
        raise Unchanged("the amount is zero")
    return value, await context.call.current(quantity)


def _within_turn(quantity: Quantity, angle: float) -> float:
    if quantity.kind is not Kind.ROTATION or quantity.range is None or quantity.allows(angle):
        return angle
    turn = quantity.from_unit(2.0 * math.pi, "rad")
    turn = round(turn, 9) if quantity.unit == "deg" else turn
    low, high = quantity.range
    if abs((high - low) - turn) > 1e-6 * turn:
        return angle
    wrapped = angle + (turn if angle < low else -turn)
    return int(wrapped) if isinstance(angle, int) and wrapped.is_integer() else wrapped


def has_direction(quantity: Quantity) -> bool | None:
    """Return whether a speed or ratio can be negative; None if the vocabulary does not say.

    What the vocabulary allows decides first. Otherwise, a component along an axis, the speed of a joint and
    a vector have a direction. A number of its own may be the speed of a motor or a speed limit.
    """
    if quantity.values is not None:
        return any(value < 0 for value in quantity.values)
    limits = quantity.range or quantity.clip
    if limits is not None:
        return limits[0] < 0
    return True if quantity.axis is not None or _is_part_of_vector(quantity.path) else None


def _is_part_of_vector(path: Path) -> bool:
    """Return whether a path leads to a component of a vector, such as ``linear.x``, or to a slice of one."""
    if not path.steps:
        return path.root in _COMPONENTS
    last = path.steps[-1]
    return last.bounds is not None or last.attribute in _COMPONENTS or last.item in _COMPONENTS
