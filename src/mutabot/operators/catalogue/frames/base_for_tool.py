"""base-for-tool: a relative move is carried out in the other frame: along the tool's axes, or the base's."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from random import Random
from typing import ClassVar

from mutabot.families import CATALOGUE
from mutabot.model import (
    Call,
    Kind,
    Middleware,
    Mode,
    NotToldError,
    Operation,
    Path,
    Pattern,
    Proceed,
    Quantity,
    Reply,
)
from mutabot.model.values.quantity import Value
from mutabot.model.values.rotation import Quaternion, from_euler, inverse, product
from mutabot.operators._evidence import FRAMES
from mutabot.operators.operator import Example, Operator, Subject, is_number
from mutabot.operators.robot._values import NOT_GIVEN, label, quantity_of, why_away

_BASE, _TOOL = "base", "tool"
_AXES = "xyz"
#: how three angles about x, y and z are read: one after the other about axes that stay
_ORDER = "xyz"
_NO_ORIENTATION = "nothing tells how the tool is turned"
_MOVES = tuple(Quantity(axis, Path(axis), Kind.TRANSLATION, axis, "m", _BASE, Mode.BY) for axis in _AXES)
_MOVE = Operation("robot:Arm.move_by", _MOVES, current="robot:Arm.tool_pose")
_DOWN = {"theta_x": 180.0, "theta_y": 0.0, "theta_z": 90.0}


class BaseForTool(Operator):
    """Turns a relative translation by the tool's orientation, or back."""

    name = "base-for-tool"
    family = CATALOGUE
    asks_where = True
    summary = (
        "A relative move in the base's frame goes along the tool's axes, and one in the tool's along the"
        " base's."
    )
    rank = 313
    stands_for = f"A wrong or missing transform: {FRAMES}."
    where = (
        "relative translations along x, y and z in a frame named base or tool, with a current that reads"
        " the three angles of the tool, about axes that stay, in the base's frame"
    )
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MOVE, quantity=_MOVES[0]),
            {"x": 0.1, "y": 0.0, "z": 0.2},
            current=_DOWN,
            performed=({"x": 0.0, "y": 0.1, "z": -0.2},),
            note="the tool looks down, turned by a quarter",
        ),
        Example(
            Subject(_MOVE, quantity=_MOVES[0]),
            {"x": 0.1, "y": 0.0, "z": 0.2},
            current={"theta_x": 0.0, "theta_y": 0.0, "theta_z": 0.0},
            away="both frames have the same axes",
        ),
        Example(Subject(_MOVE, quantity=_MOVES[0]), {"x": 0.1}, current=_DOWN, away="the call gives no y"),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        moved = _moved(whole)
        if whole.current is not None and len(moved) == len(_AXES):
            yield replace(whole, quantity=moved[0])

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        moved = _moved(subject)

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            before = {one.name: call.values.get(one.name) for one in moved}
            if not all(is_number(value) for value in before.values()):
                return await proceed(call.as_is(NOT_GIVEN))
            try:
                tool = await _orientation(call, moved[0])
            except NotToldError:
                return await proceed(call.as_is(_NO_ORIENTATION))
            after = turned(before, tool if moved[0].frame == _BASE else inverse(tool))
            away = [why_away(one, before[one.name], after[one.name]) for one in moved]
            same = why_away(moved[0], 1.0, 1.0)
            serious = [why for why in away if why and why != same]
            if serious or all(away):
                return await proceed(call.as_is((serious or away)[0]))
            return await proceed(replace(call, values={**call.values, **after}))

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        frame = quantity_of(subject).frame
        names = ", ".join(label(one) for one in _moved(subject))
        return f"{names} along the axes of the {_TOOL if frame == _BASE else _BASE}"


def _moved(subject: Subject) -> list[Quantity]:
    """The relative translation along the three axes, in their order, of one frame."""
    found = {
        (one.frame, one.axis): one
        for one in subject.written
        if one.kind is Kind.TRANSLATION and one.mode is Mode.BY
    }
    for frame in (_BASE, _TOOL):
        moved = [found[frame, axis] for axis in _AXES if (frame, axis) in found]
        if len(moved) == len(_AXES):
            return moved
    return []


async def _orientation(call: Call, moved: Quantity) -> Quaternion:
    """How the tool is turned in the base's frame, by its three angles."""
    asked = (Quantity(f"theta_{axis}", Path(), Kind.ROTATION, axis, "deg", _BASE, Mode.TO) for axis in _AXES)
    angles = [one.from_unit(await call.current(one), "deg") for one in asked]
    radians = Quantity("angle", Path(), Kind.ROTATION, unit="rad")
    return from_euler([radians.from_unit(angle, "deg") for angle in angles], _ORDER)


def turned(values: Mapping[str, Value], by: Quaternion) -> dict[str, float]:
    """Three components, turned; numbers that are but rounding become zero."""
    x, y, z = values.values()
    _, *parts = product(product(by, (0.0, x, y, z)), inverse(by))
    size = max(abs(x), abs(y), abs(z))
    return {name: 0.0 if abs(part) < 1e-12 * size else part for name, part in zip(values, parts, strict=True)}
