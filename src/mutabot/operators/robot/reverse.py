"""reverse: a motion goes the other way."""

from __future__ import annotations

import math
from dataclasses import replace
from random import Random
from typing import ClassVar

from mutabot.model import (
    Call,
    Kind,
    Middleware,
    Mode,
    NotToldError,
    Operation,
    Path,
    Proceed,
    Quantity,
    Reply,
)
from mutabot.model.values.direction import EITHER, has_direction
from mutabot.model.values.quantity import Value
from mutabot.operators.operator import Example, Subject, is_number, map_numbers
from mutabot.operators.rule import Published

from ._orientation import the_other_way
from ._values import NOT_GIVEN, NOT_TOLD, WrittenValueOperator, label, quantity_of, why_away

_DY = Quantity("dy", Path("dy"), Kind.TRANSLATION, "y", "m", "base", Mode.BY)
_YAW = Quantity("yaw", Path("yaw"), Kind.ROTATION, "z", "deg", "base", Mode.BY)
_TURN = Quantity("angle", Path("angle"), Kind.ROTATION, "z", "deg", None, Mode.TO, range=(0.0, 360.0))
_LIFT = Quantity("z", Path("z"), Kind.TRANSLATION, "z", "m", "base", Mode.TO, range=(0.0, 0.5))
_PUSH = Quantity("push", Path("push"), Kind.TRANSLATION, "x", "m", None, Mode.BY, range=(-1.0, 1.0))
_LIMITED = replace(_PUSH, clip=(-1.0, 1.0))
_FACING = replace(_TURN, range=None)
_MOVE = Operation("robot:Arm.move_by", (_DY, _YAW))
_TURN_TO = Operation("robot:Arm.turn_to", (_TURN,))
_FACE = Operation("robot:Arm.face", (_FACING,))
_STEP = Operation("env:Env.step", (_PUSH,))
_CLIPPED = Operation("env:Env.step", (_LIMITED,))
_ROTVEC = Quantity("rotation", Path("rotation"), Kind.ROTATION_VECTOR, unit="rad")
_ORIENT = Operation("robot:Arm.orient", (_ROTVEC,))
_PATH = Path.parse("message.pose.x", rooted=True)
_GOAL = Quantity("pose.x", _PATH, Kind.TRANSLATION, "x", "m", mode=Mode.TO, relative=True)
_HIDDEN = Operation("publish /arm/goal", (_GOAL,), current="receive /arm/pose")
_LIFT_TO = Operation("robot:Arm.lift_to", (_LIFT,))
_AHEAD = Quantity("linear.x", Path.parse("message.linear.x", rooted=True), Kind.SPEED, "x", "m/s")
_DRIVE = Operation("publish /cmd_vel", (_AHEAD,))
_SLOWLY = Quantity("speed", Path("speed"), Kind.SPEED, None, "m/s", range=(-0.2, 1.0))
_GO = Operation("base:Base.go", (_SLOWLY,))


class Reverse(WrittenValueOperator):
    """Negates one component of a motion, or mirrors a target at where the robot is."""

    name = "reverse"
    summary = "A translation, rotation or speed goes the other way: one component is negated."
    rank = 10
    where = "written translations, rotations, orientations as a whole, and speeds and ratios with a direction"
    published = (
        Published(1, "rotate left by θ", "rotate right by θ"),
        Published(2, "rotate right by θ", "rotate left by θ"),
        Published(3, "translate forward by δ", "translate backwards by δ"),
        Published(4, "translate backwards by δ", "translate forward by δ"),
    )
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MOVE, quantity=_DY),
            {"dy": 0.2, "yaw": 0.0},
            performed=({"dy": -0.2, "yaw": 0.0},),
            note="translate forward by δ: translate backwards by δ",
        ),
        Example(Subject(_MOVE, quantity=_DY), {"dy": -0.9}, performed=({"dy": 0.9},)),
        Example(
            Subject(_MOVE, quantity=_YAW),
            {"dy": 0.0, "yaw": 80},
            performed=({"dy": 0.0, "yaw": -80},),
            note="rotate left by θ: rotate right by θ",
        ),
        Example(Subject(_MOVE, quantity=_DY), {"dy": [0.1, -0.2]}, performed=({"dy": [-0.1, 0.2]},)),
        Example(
            Subject(_TURN_TO, quantity=_TURN),
            {"angle": 90},
            performed=({"angle": 270},),
            note="an angle limited to a full turn stays within it",
        ),
        Example(
            Subject(_ORIENT, quantity=_ROTVEC),
            {"rotation": [0.0, 0.5, 0.0]},
            performed=({"rotation": [0.0, -0.5, 0.0]},),
            note="an orientation as a whole: the inverse rotation",
        ),
        Example(
            Subject(_CLIPPED, quantity=_LIMITED),
            {"push": 1.7},
            performed=({"push": -1.7},),
            note="the vocabulary says that the robot limits it: clip = [−1, 1]",
        ),
        Example(Subject(_STEP, quantity=_PUSH), {"push": 1.7}, away="−1.7 m is outside the range [−1, 1]"),
        Example(
            Subject(_ORIENT, quantity=_ROTVEC),
            {"rotation": [0.0, math.pi, 0.0]},
            away="half a turn the other way is the same orientation",
        ),
        Example(
            Subject(_FACE, quantity=_FACING),
            {"angle": 180},
            away="the targets 180 and −180 degrees are the same",
        ),
        Example(
            Subject(_HIDDEN, quantity=_GOAL),
            {"pose.x": 0.5},
            current={"pose.x": 0.3},
            performed=({"pose.x": 0.1},),
            note="a relative move that is hidden in an absolute target: 2 · current − target",
        ),
        Example(
            Subject(_HIDDEN, quantity=_GOAL),
            {"pose.x": 0.5},
            current={"pose.x": 0.5},
            away="the target is where the robot is",
        ),
        Example(
            Subject(_DRIVE, quantity=_AHEAD),
            {"linear.x": 0.4},
            performed=({"linear.x": -0.4},),
            note="a speed along an axis: the robot drives the wrong way",
        ),
        Example(
            Subject(_GO, quantity=_SLOWLY), {"speed": 0.5}, away="−0.5 m/s is outside the range [−0.2, 1]"
        ),
        Example(Subject(_MOVE, quantity=_DY), {"dy": 0.0}, away="a zero has no other way"),
        Example(Subject(_MOVE, quantity=_DY), {"yaw": 80}, away="the call does not give this component"),
        Example(Subject(_LIFT_TO, quantity=_LIFT), {"z": 0.3}, away="−0.3 m is outside the allowed range"),
    )

    def needs_where(self, subject: Subject) -> bool:
        return quantity_of(subject).relative

    def needs_sign(self, subject: Subject) -> bool:
        quantity = quantity_of(subject)
        return quantity.kind in EITHER and has_direction(quantity) is None

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = quantity_of(subject)
        if not quantity.relative:
            return super().middleware(subject, random)

        async def mirrored(call: Call, proceed: Proceed) -> Reply:
            value = call.values.get(quantity.name)
            if value is None or not is_number(value):
                return await proceed(call.as_is(NOT_GIVEN))
            try:
                here = await call.current(quantity)
            except NotToldError:
                return await proceed(call.as_is(NOT_TOLD))
            changed = _within_turn(quantity, 2.0 * here - value)
            why = why_away(quantity, value, changed)
            return await proceed(call.as_is(why) if why else call.with_value(quantity, changed))

        return mirrored

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        if not quantity.relative:
            return super().describe(subject, before, after)
        return f"{label(quantity)} {quantity.text(before)} → as far to the other side of where it is"

    def fits(self, quantity: Quantity) -> bool:
        if quantity.kind in EITHER:
            return has_direction(quantity) is not False
        return quantity.kind in (Kind.TRANSLATION, Kind.ROTATION) or quantity.is_whole

    def change(self, subject: Subject, value: Value, random: Random) -> Value | None:
        quantity = quantity_of(subject)
        if quantity.is_whole:
            return the_other_way(quantity, value)
        return map_numbers(value, lambda number: _within_turn(quantity, -number))


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
