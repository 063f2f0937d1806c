"""Waits that end early, commands and readings that come late."""

from __future__ import annotations

from typing import ClassVar

from mutabot.families import GRADED
from mutabot.model import Call, Kind, Operation, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.model.values.units import Dimension, convert
from mutabot.operators.command import CommandOperator
from mutabot.operators.context import Context
from mutabot.operators.examples import changed, reading, unchanged, writing
from mutabot.operators.magnitudes import Ladder, ladder_in
from mutabot.operators.operator import Example, Need, Subject
from mutabot.operators.rule import TIMING

from ._number import NumberOperator

_PAUSE = writing("cell:Cell.wait", "seconds", Kind.DURATION, unit="s", range=(0.0, 3600.0))
_HOME = Operation("robot:Arm.home")
_FEEL = reading("sensor:gap", Kind.DISTANCE, unit="m")


class Early(NumberOperator):
    """Ends a wait before its time."""

    name = "early"
    summary = "A wait is so much shorter, so that what comes next comes too early."
    where = "waits: arguments of kind `duration`"
    stands_for = f"A wait that was measured on a faster machine: {TIMING}."
    rank = 270
    directions = ("-",)
    of_read = False
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_PAUSE, 0.8, 0.6, size=("-", 200.0, "ms"), note="the gripper is given less time to close"),
        unchanged(_PAUSE, 0.8, "no wait is shorter than nothing", size=("-", 1000.0, "ms")),
    )

    def magnitudes(self, quantity: Quantity) -> Ladder | None:
        return ladder_in(quantity, Dimension.TIME) if quantity.kind is Kind.DURATION else None

    def number(self, size: float, value: float, context: Context) -> float:
        after = value + size
        return after if after >= -1e-9 else value


class Lag(CommandOperator):
    """Lets time pass before a command, and after a reading was taken."""

    name = "lag"
    family = GRADED
    has_sizes = True
    summary = (
        "Each command is carried out so much later, while the rest of the world goes on; a reading was taken "
        "so much before the program gets it. Needs a `wait` in the vocabulary, or a middleware."
    )
    where = (
        "every command that is no wait, and every reading, with a `wait` in the vocabulary or a middleware"
    )
    stands_for = f"A busy network or controller: {TIMING}."
    rank = 260
    needs = frozenset({Need.WAIT, Need.PROGRAM})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_HOME, variant="200ms", magnitude=200.0, unit="ms"), performed=({},), waited=0.2),
        Example(
            Subject(_FEEL, variant="50ms", magnitude=50.0, unit="ms"),
            replied={"result": 0.3},
            performed=({},),
            waited=0.05,
            note="what was seen then is told now",
        ),
    )

    def fits(self, whole: Subject) -> bool:
        waits = any(one.kind is Kind.DURATION for one in whole.written)
        return (whole.is_command or bool(whole.read)) and not waits

    def magnitudes(self, whole: Subject) -> Ladder | None:
        named = next((one for one in (*whole.written, *whole.read) if one.ladder_unit is not None), None)
        return ladder_in(named, Dimension.TIME)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        seconds = convert(context.subject.magnitude or 0.0, context.subject.unit or "s", "s")
        if call.is_command:
            await call.wait(seconds)
            return await proceed(call)
        reply = await proceed(call)
        await call.wait(seconds)
        return reply

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        what = "is carried out" if subject.is_command else "comes"
        return f"{what} {subject.magnitude:g} {subject.unit} later"
