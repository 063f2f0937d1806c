"""Operators on commands: lost, repeated, taken back, too early, too late or in the wrong order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

from mutabot.api.faults import CommandOperator, Context, Example, Need, Subject, Unchanged, ValueOperator
from mutabot.api.values import Call, Kind, Operation, Proceed, Quantity, Reply

from ._examples import CLOSE, GRIP, MOVE_BY, MOVE_TO
from .values import CATALOGUE, like

#: seconds: as long as a pneumatic gripper takes to open or close
_LATE = 0.5
_GRIPPING = (
    "commands with an opening, and commands without quantities that have an opposite, such as close and open"
)
_REFUSED = replace(MOVE_BY, refusals=("robot:Refused",))
_WAIT = Operation.writing("cell:wait", "seconds", Kind.DURATION, unit="s", range=(0.0, 60.0))


def _is_motion(quantity: Quantity) -> bool:
    return quantity.is_whole or quantity.kind in (Kind.TRANSLATION, Kind.ROTATION)


class _Timing(CommandOperator):
    """Does something at another time, or in another order.

    Stands for: Something too early, too late or in the wrong order: {timing}.
    """

    family = CATALOGUE
    needs = frozenset({Need.PROGRAM})


class SwapNext(_Timing):
    """A command changes places with the program's next one, or is never carried out if none follows.

    Where: any command whose answer to doing nothing is known.
    """

    name = "swap-next"
    needs = frozenset({Need.IDLE, Need.PROGRAM})
    fault = "only after the next command"
    examples = (Example(Subject(MOVE_BY), {"dx": 0.1}, performed=(), afterwards=({"dx": 0.1},)),)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        reply = call.idle_reply
        call.defer(call)
        return reply


class PreviousTarget(_Timing):
    """A motion goes to the target of the one before it again, or as far: an outdated waypoint.

    Where: commands that write a translation or rotation, from the second call of their operation on.
    """

    name = "previous-target"
    fault = "the motion of the call before it again"
    examples = (
        Example.whole(MOVE_TO, {"x": 0.4, "y": 0.1}, {"x": 0.2, "y": 0.0}, previous={"x": 0.2, "y": 0.0}),
        Example.whole(MOVE_TO, 0.4, away="no call came before it"),
        Example.whole(MOVE_TO, 0.4, previous={"x": 0.4}, away="it went there before"),
    )

    def fits(self, whole: Subject) -> bool:
        return whole.is_command and any(map(_is_motion, whole.written))

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        before = call.previous()
        if before is None:
            raise Unchanged("no call came before it")
        names = before.keys() & call.values.keys()
        moved = [
            quantity
            for quantity in context.subject.written
            if _is_motion(quantity) and quantity.name in names
        ]
        if all(quantity.is_same(before[quantity.name], call.values[quantity.name]) for quantity in moved):
            raise Unchanged("the one before it was the same")
        values = {quantity.name: before[quantity.name] for quantity in moved}
        return await proceed(replace(call, values={**call.values, **values}))


class HalfWait(ValueOperator):
    """A wait is half as long.

    Where: written quantities of kind duration.

    Stands for: Something too early, too late or in the wrong order: {timing}.
    """

    name = "half-wait"
    family = CATALOGUE
    kinds = frozenset({Kind.DURATION})
    of_read = False
    examples = (
        Example.changed(_WAIT, 0.8, 0.4),
        Example.unchanged(_WAIT, 0.0, "there is nothing to shorten"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        return context.quantity.map_numbers(value, lambda number: like(number, number / 2.0))


class NoWait(HalfWait):
    """A wait is left out."""

    name = "no-wait"
    is_common = True
    examples = (
        Example.changed(_WAIT, 0.8, 0.0),
        Example.unchanged(_WAIT, 0.0, "there is nothing to shorten"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        return context.quantity.map_numbers(value, lambda number: like(number, 0.0))


class _Grip(_Timing):
    """Does something with a command to a gripper."""

    where = _GRIPPING

    def fits(self, whole: Subject) -> bool:
        has_opening = any(quantity.kind is Kind.OPENING for quantity in whole.written)
        return whole.is_command and (has_opening or (whole.opposite is not None and not whole.written))


class LateGrip(_Grip):
    """A gripper command is carried out 0.5 s late, and the program waits for it. Needs a `wait`."""

    name = "late-grip"
    needs = frozenset({Need.WAIT, Need.PROGRAM})
    where = f"{_GRIPPING}; the vocabulary says how time passes: wait"
    fault = f"{_LATE:g} s late"
    examples = (Example(Subject(GRIP), {"position": 1}, waited=_LATE, performed=({"position": 1},)),)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        await call.wait(_LATE)
        return await proceed(call)


class EarlyRelease(_Grip):
    """A gripper command is taken back right after the program's next command, if one follows."""

    name = "early-release"
    fault = "and back after the next command"
    examples = (
        Example(Subject(GRIP), {"position": 1}, performed=({"position": 1},), afterwards=({"position": 0},)),
        Example(Subject(CLOSE), performed=({},), afterwards=({"reversed": True},)),
        Example(Subject(GRIP), {"position": 0.5}, away="half open has no opposite"),
    )

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        back = _undone(context.subject, call)
        reply = await proceed(call)
        call.defer(back)
        return reply


def _undone(subject: Subject, call: Call) -> Call:
    """Return the call that takes a gripper command back. Raises Unchanged if its opening has no other end."""
    for quantity in subject.written:
        if quantity.kind is Kind.OPENING:
            value = replace(subject, quantity=quantity).given(call.values, quantity.name)
            end = quantity.other_end(value)
            if end is None:
                raise Unchanged(f"the value is at neither end of the range or values of {quantity.name}")
            return call.with_value(quantity, end)
    return call.opposite()


class _Chance(CommandOperator):
    """Acts on a command by chance; the variant says how likely that is.

    Stands for: A command that is lost, or comes twice: {commands}.
    """

    family = CATALOGUE
    by_chance = True
    needs = frozenset({Need.MEMORY, Need.PROGRAM})
    variants: ClassVar[Mapping[str, float]] = {"30%": 0.3}


class LostCommand(_Chance):
    """A command is not carried out, with a probability of 30 %.

    Where: any command whose answer to doing nothing is known.
    """

    name = "lost-command"
    needs = frozenset({Need.IDLE, Need.MEMORY, Need.PROGRAM})
    fault = "do nothing, with a probability of {variant}"
    examples = (
        Example.whole(GRIP, 1, variant="30%"),
        Example.whole(GRIP, 1, variant="30%", earlier=(0, 0, 0), away="most commands are carried out"),
    )

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        context.by_chance()
        return call.idle_reply


class DoubleCommand(_Chance):
    """A command is carried out twice, with a probability of 30 %.

    Where: any command.
    """

    name = "double-command"
    fault = "do it twice, with a probability of {variant}"
    examples = (
        Example.whole(MOVE_BY, 0.1, 0.1, 0.1, variant="30%"),
        Example.whole(MOVE_BY, 0.1, variant="30%", earlier=(0.2,) * 3, away="most are carried out once"),
    )

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        context.by_chance()
        await proceed(call)
        return await proceed(call)


class UnreportedRefusal(CommandOperator):
    """The robot refuses a command, or stops, and the program does not hear of it.

    Where: commands whose answer to doing nothing is known, where the tests make the robot raise one of its
    refusals.

    Stands for: Errors that are swallowed on their way: {commands}.
    """

    name = "unreported-refusal"
    by_chance = True  # what the robot refuses only the run shows
    family = CATALOGUE
    needs = frozenset({Need.IDLE, Need.ERROR, Need.PROGRAM})
    fault = "a refusal is not reported"
    examples = (
        Example(Subject(_REFUSED), {"dx": 9.0}, refused=True, performed=({"dx": 9.0},), received={}),
        Example(Subject(_REFUSED), {"dx": 0.1}, away="the robot does not refuse it"),
    )

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        try:
            reply = await proceed(call)
        except Exception as error:
            if not call.is_refusal(error):
                raise
            return call.idle_reply
        return reply.as_is("the robot does not refuse it")
