"""Commands that are lost, repeated, taken back, too early, too late or in the wrong order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

from mutabot.families import CATALOGUE
from mutabot.model import Call, Kind, Proceed, Reply
from mutabot.model.quantity import WHOLE, Value, are_same
from mutabot.operators.command import CommandOperator, idle_of
from mutabot.operators.examples import CLOSE, GRIP, MOVE_BY, MOVE_TO, changed, unchanged, whole, writing
from mutabot.operators.kinds.commands import other_end
from mutabot.operators.operator import Context, Example, Need, Subject, Unchanged
from mutabot.operators.value import ValueOperator, given, map_numbers

from .values import like

#: seconds: as long as a pneumatic gripper takes to open or close
_LATE = 0.5
_MOTIONS = WHOLE | {Kind.TRANSLATION, Kind.ROTATION}
_GRIPPING = (
    "commands with an opening, and commands without quantities that have an opposite, such as close and open"
)
_REFUSED = replace(MOVE_BY, refusals=("robot:Refused",))
_WAIT = writing("cell:wait", "seconds", Kind.DURATION, unit="s", range=(0.0, 60.0))


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
        reply = idle_of(call)
        call.defer(call)
        return reply


class PreviousTarget(_Timing):
    """A motion goes to the target of the one before it again, or as far: an outdated waypoint.

    Where: commands that write a translation or rotation, from the second call of their operation on.
    """

    name = "previous-target"
    fault = "the motion of the call before it again"
    examples = (
        whole(MOVE_TO, {"x": 0.4, "y": 0.1}, {"x": 0.2, "y": 0.0}, previous={"x": 0.2, "y": 0.0}),
        whole(MOVE_TO, 0.4, away="there is none before it"),
        whole(MOVE_TO, 0.4, previous={"x": 0.4}, away="it went there before"),
    )

    def fits(self, whole: Subject) -> bool:
        return whole.is_command and any(one.kind in _MOTIONS for one in whole.written)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        before, written = call.previous(), context.subject.written
        if before is None:
            raise Unchanged("there is none before it")
        names = {one.name for one in written if one.kind in _MOTIONS} & before.keys()
        values = {name: before[name] if name in names else value for name, value in call.values.items()}
        if are_same(written, values, call.values):
            raise Unchanged("the one before it was the same")
        return await proceed(replace(call, values=values))


class HalfWait(ValueOperator):
    """A wait is half as long.

    Where: written quantities of kind duration.

    Stands for: Something too early, too late or in the wrong order: {timing}.
    """

    name = "half-wait"
    family = CATALOGUE
    kinds = frozenset({Kind.DURATION})
    of_read = False
    examples = (changed(_WAIT, 0.8, 0.4), unchanged(_WAIT, 0.0, "there is nothing to shorten"))

    def change(self, value: Value, context: Context) -> Value | None:
        return map_numbers(value, lambda number: like(number, number / 2.0))


class NoWait(HalfWait):
    """A wait is left out."""

    name = "no-wait"
    examples = (changed(_WAIT, 0.8, 0.0), unchanged(_WAIT, 0.0, "there is nothing to shorten"))

    def change(self, value: Value, context: Context) -> Value | None:
        return map_numbers(value, lambda number: like(number, 0.0))


class _Grip(_Timing):
    """Does something with a command to a gripper."""

    where = _GRIPPING

    def fits(self, whole: Subject) -> bool:
        has_opening = any(one.kind is Kind.OPENING for one in whole.written)
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
    """The call that takes a gripper command back. Raises Unchanged if its opening has no other end."""
    for quantity in subject.written:
        if quantity.kind is Kind.OPENING:
            value = given(call.values, quantity.name, replace(subject, quantity=quantity))
            return call.with_value(quantity, other_end(quantity, value))
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
        whole(GRIP, 1, variant="30%"),
        whole(GRIP, 1, variant="30%", earlier=(0, 0, 0), away="most commands are carried out"),
    )

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        context.by_chance()
        return idle_of(call)


class DoubleCommand(_Chance):
    """A command is carried out twice, with a probability of 30 %.

    Where: any command.
    """

    name = "double-command"
    fault = "do it twice, with a probability of {variant}"
    examples = (
        whole(MOVE_BY, 0.1, 0.1, 0.1, variant="30%"),
        whole(MOVE_BY, 0.1, variant="30%", earlier=(0.2,) * 3, away="most commands are carried out once"),
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
    by_chance = True  # what the robot refuses only the run can tell
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
            return idle_of(call)
        return reply.as_is("the robot does not refuse it")
