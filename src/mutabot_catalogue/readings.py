"""Operators on readings that are old, stuck, limited, lost, late or of something else."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any, ClassVar

from mutabot.api.faults import CommandOperator, Context, Example, Need, Subject, Unchanged, ValueOperator
from mutabot.api.values import Call, Kind, Operation, Path, Proceed, Quantity, Reply

from .values import CATALOGUE, Exchange, comes_by_itself, is_alike, like, middle_of, within

_NONE, _NAN = "none", "nan"
_MEASURE = Operation.reading("laser:distance", Kind.DISTANCE, unit="m")
_NEAR = Operation.reading("laser:near", Kind.DISTANCE, unit="m", range=(0.0, 2.0))
_SEE = Operation.reading("camera:colour", Kind.LABEL, values=("red", "blue"))
_OR_NAN = Operation.reading("laser:distance", Kind.DISTANCE, unit="m", missing=_NAN)
_OR_NONE = Operation.reading("camera:colour", Kind.LABEL, values=("red", "blue"), missing=_NONE)
_X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m", missing="camera:NoImageError")
_OR_ERROR = Operation("camera:locate", result=(_X,), command=False)
_WHICH = Quantity("which", Path("which"), Kind.OUTPUT, values=("nut", "bolt", "washer"))
_FIND = replace(_MEASURE, target="camera:distance_of", arguments=(_WHICH,))
_CHANNELS = tuple(
    Quantity(f".{name}", Path.parse(f".{name}", rooted=False), Kind.POSITION, name, "m", "world")
    for name in "xy"
)
_LOCATE = Operation("camera:locate", result=_CHANNELS, command=False)
#: kinds of numbers on a scale, but for orientations as a whole
_SCALARS = frozenset(kind for kind in Kind if kind.is_measured and not kind.is_whole)
#: seconds: a camera whose picture has to be worked out
_LATE = 0.5


class Dropout(CommandOperator):
    """A reading drops out: the program gets None, not a number or an exception, as its `missing` says.

    Where: read quantities whose vocabulary says what a reading gives that is not there: missing.

    Stands for: A sensor that drops out or is misread: {sensors}.
    """

    name = "dropout"
    family = CATALOGUE
    examples = (
        Example.changed(_OR_NAN, 0.2, math.nan),
        Example.changed(_OR_NONE, "red", None),
        Example(
            Subject(_OR_ERROR, quantity=_X), replied={".x": 0.2}, performed=({},), fails="camera:NoImageError"
        ),
        Example.unchanged(_OR_NAN, {}, "there is no reading anyway"),
    )

    def subjects(self, whole: Subject) -> Iterator[Subject]:
        raised: set[str] = set()
        for quantity in whole.read:
            if quantity.missing in (_NONE, _NAN):
                yield replace(whole, quantity=quantity)
            elif quantity.missing and quantity.missing not in raised and not comes_by_itself(whole.operation):
                raised.add(quantity.missing)  # the whole call raises; what comes by itself raises nothing
                yield replace(whole, quantity=quantity)

    def only_reads(self, subject: Subject) -> bool:
        return subject.required_quantity.missing in (_NONE, _NAN)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        quantity, reply = context.quantity, await proceed(call)
        if quantity.name not in reply.values:
            return reply.as_is(context.subject.why_missing)
        if quantity.missing == _NONE:
            return reply.with_value(quantity, None)
        if quantity.missing != _NAN:
            return reply.failing(quantity.missing or "")
        nothing = quantity.map_numbers(reply.values[quantity.name], lambda _: math.nan)
        if nothing is None:
            return reply.as_is("its value is not a number")
        return reply.with_value(quantity, nothing)

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        quantity = subject.required_quantity
        gets = {_NONE: "reads None", _NAN: "reads not a number"}
        what = gets.get(quantity.missing or "", f"raises {quantity.missing}")
        return f"{what} instead of {quantity.label} {quantity.text(before)}"


class _ChangedReading(ValueOperator):
    """Changes a reading depending on earlier ones at its place, or at random.

    Stands for: A sensor that drops out or is misread: {sensors}.
    """

    family = CATALOGUE
    needs = frozenset({Need.MEMORY})
    of_written = False


class OldReading(_ChangedReading):
    """A reading is that of the call before, or of five calls before, at the same place.

    Where: read quantities, at places that a test calls more than once.
    """

    name = "old-reading"
    is_common = True
    kinds = frozenset(Kind)
    variants: ClassVar[Mapping[str, int]] = {"1": 1, "5": 5}
    examples = (
        Example.changed(_MEASURE, 0.2, 0.3, "1", earlier=(0.5, 0.3)),
        Example.unchanged(_MEASURE, 0.2, "no reading is that old yet", "5", earlier=(0.5,)),
    )

    def least_calls(self, subject: Subject) -> int:
        return self.variants[subject.variant] + 1

    def change(self, value: Any, context: Context) -> Any | None:
        context.memory.append(_kept(value))
        old = context.memory.pop(0) if len(context.memory) > context.option else None
        if old is None:
            raise Unchanged("no reading is that old yet")
        return old

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        calls = "1 call" if subject.variant == "1" else f"{subject.variant} calls"
        return f"reads the {subject.required_quantity.label} of {calls} ago"


class StuckReading(_ChangedReading):
    """From the second call on a place reads what it read first in the test.

    Where: read quantities, at places that a test calls more than once.
    """

    name = "stuck-reading"
    calls = 2
    kinds = frozenset(Kind)
    examples = (
        Example.changed(_MEASURE, 0.2, 0.5, earlier=(0.5, 0.3)),
        Example.unchanged(_MEASURE, 0.2, "it is the first reading"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        if not context.memory:
            context.memory.append(_kept(value))
            raise Unchanged("it is the first reading")
        return _kept(context.memory[0])

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        return f"reads the first {subject.required_quantity.label} again and again"


def _kept(value: Any) -> Any:
    """Return a copy of a value, which later changes of the value do not reach."""
    return copy.copy(value) if hasattr(value, "__len__") and not isinstance(value, str | bytes) else value


class Spike(_ChangedReading):
    """One reading in ten, by chance, jumps to the farther end of its range, or to ten times its value if it
    has none.

    Where: read numbers on a scale, but for orientations as a whole.
    """

    name = "spike"
    by_chance = True
    kinds = _SCALARS
    variants: ClassVar[Mapping[str, float]] = {"10%": 0.1}
    examples = (
        Example.changed(_MEASURE, 0.2, 2.0, "10%", earlier=(0.2,)),
        Example.changed(_NEAR, 0.2, 2.0, "10%", earlier=(0.2,)),
        Example.unchanged(_MEASURE, 0.2, "nine of ten", "10%"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        context.by_chance()
        limits = context.quantity.range
        if limits is None:
            return context.quantity.map_numbers(value, lambda number: like(number, 10.0 * number))
        return context.quantity.map_numbers(
            value, lambda number: like(number, max(limits, key=lambda end: abs(end - number)))
        )

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        quantity = subject.required_quantity
        jump = "the far end of its range" if quantity.range is not None else "10 times as much"
        return f"reads {quantity.label} {quantity.text(before)}, now and then {jump}"


class SaturatedReading(_ChangedReading):
    """A reading is limited to the middle 80 % of its range, or without a range to 80 % of the first one at
    its place in the test.

    Where: read numbers on a scale, but for orientations as a whole.
    """

    name = "saturated-reading"
    kinds = _SCALARS
    examples = (
        Example.changed(_NEAR, 1.9, 1.8),
        Example.changed(_MEASURE, -0.5, -0.4, earlier=(0.5,)),
        Example.unchanged(_NEAR, 1.0, "it is in the middle"),
        Example.unchanged(_MEASURE, 0.1, "it is less than 80 % of the first", earlier=(0.5,)),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        quantity, memory = context.quantity, context.memory
        if quantity.range is not None:
            limits = middle_of(quantity, 0.8)
        elif quantity.is_scalar(value):
            if not memory:
                memory.append(0.8 * abs(value))
            limits = (-memory[0], memory[0])
        else:
            return None
        return context.quantity.map_numbers(value, lambda number: within(number, limits))


class SwappedChannels(Exchange):
    """Neighbouring values of one kind that a call reads are exchanged.

    Where: calls that read two quantities of one kind and unit.

    Stands for: A sensor that drops out or is misread: {sensors}.
    """

    name = "swapped-channels"
    examples = (
        Example.changed(_LOCATE, {".x": 0.4, ".y": 0.1}, {".x": 0.1, ".y": 0.4}, "y"),
        Example.unchanged(_LOCATE, 0.4, "it reads no y this time", "y"),
    )

    def pairs(self, whole: Subject) -> Iterator[tuple[Quantity, Quantity]]:
        groups: list[list[Quantity]] = []
        for quantity in whole.read:
            group = next((known_group for known_group in groups if is_alike(known_group[0], quantity)), None)
            groups.append([quantity]) if group is None else group.append(quantity)
        for group in groups:
            yield from pairwise(group)


class WrongObject(ValueOperator):
    """A reading is that of another object, camera or channel.

    Where: outputs with values that say what a call reads: written beside a result.

    Stands for: A sensor that drops out or is misread: {sensors}.
    """

    name = "wrong-object"
    family = CATALOGUE
    of_read = False
    examples = (
        Example.changed(_FIND, "washer", "nut", replied={"result": 0.3}),
        Example.unchanged(_FIND, "screw", "it is not one of the values that the vocabulary gives"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return bool(whole.read) and quantity.kind is Kind.OUTPUT and len(quantity.values or ()) > 1

    def change(self, value: Any, context: Context) -> Any | None:
        return context.next_value(value)


class ConfusedLabel(_ChangedReading):
    """A label or flag is read as the next of its values, with a probability of 30 %.

    Where: read quantities of kind label or flag with two values or more.
    """

    name = "confused-label"
    by_chance = True
    variants: ClassVar[Mapping[str, float]] = {"30%": 0.3}
    examples = (
        Example.changed(_SEE, "red", "blue", "30%"),
        Example.unchanged(_SEE, "red", "most are read rightly", "30%", earlier=("red",) * 3),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind in (Kind.LABEL, Kind.FLAG) and len(quantity.values or ()) > 1

    def change(self, value: Any, context: Context) -> Any | None:
        context.by_chance()
        return context.next_value(value)

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        return f"reads another {subject.required_quantity.label}, with a probability of {subject.variant}"


class LateReading(CommandOperator):
    """The program gets a reading 0.5 s after it was taken. Needs a `wait`.

    Where: calls that read and command nothing; the vocabulary says how time passes: wait.

    Stands for: Something too early, too late or in the wrong order: {timing}.
    """

    name = "late-reading"
    family = CATALOGUE
    needs = frozenset({Need.WAIT})
    fault = f"read {_LATE:g} s before the program gets it"
    examples = (Example.whole(_MEASURE, 0.2, 0.2, waited=_LATE),)

    def fits(self, whole: Subject) -> bool:
        return bool(whole.read) and not whole.is_command and not comes_by_itself(whole.operation)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        reply = await proceed(call)
        await call.wait(_LATE)
        return reply
