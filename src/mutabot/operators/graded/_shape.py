"""What graded operators have in common: a mutant per direction and magnitude, on either side of a call."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from random import Random
from typing import ClassVar

from mutabot.families import GRADED
from mutabot.model import Call, Kind, Middleware, Mode, Operation, Pattern, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.model.values.rotation import from_rotation_vector, product
from mutabot.model.values.units import convert_difference
from mutabot.operators._draws import Draws
from mutabot.operators.operator import Operator, Subject, is_number
from mutabot.operators.robot._values import NOT_GIVEN, label, quantity_of, why_away

from ._ladders import Ladder

#: components of a slice without an end that are tried: those of an arm with seven joints
_JOINTS = 7


@dataclass(slots=True)
class Passed:
    """What an operator may know of the calls of a test that went before.

    Attributes:
        number: of the call, from 1.
        time: simulated seconds since the test's first tick; raises LookupError without a clock.
        random: the call's own generator.
        last: the number that the last call ended with; None before the first.
        is_relative: whether its numbers are changes themselves.
    """

    number: int
    time: Callable[[], float]
    random: Random
    last: float | None = None
    is_relative: bool = False


class GradedOperator(Operator):
    """Changes one number, by a magnitude.

    Class attributes:
        directions: which ways it goes.
    """

    family = GRADED
    has_sizes = True
    directions: ClassVar[tuple[str, ...]] = ("+", "-")

    @abstractmethod
    def ladder(self, quantity: Quantity, *, written: bool) -> Ladder | None:
        """The magnitudes for a quantity; None where it has nothing to say."""

    @abstractmethod
    def number(self, size: float, value: float, passed: Passed) -> float:
        """The new number. ``size``: the magnitude in the quantity's unit, negative in the direction ``-``."""

    def size_of(self, subject: Subject) -> float:
        """The magnitude in the quantity's unit, with its sign."""
        quantity, size = quantity_of(subject), subject.magnitude or 0.0
        unit = self.unit_of(subject)
        if unit is not None and unit != quantity.unit:
            size = convert_difference(size, unit, quantity.unit or "rad")
        return -size if subject.direction.endswith("-") else size

    def unit_of(self, subject: Subject) -> str | None:
        """The unit of what is added to the value."""
        return subject.unit

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        whole = Subject(operation, pattern)
        for quantities, written in ((whole.written, True), (whole.read, False)):
            for quantity in quantities:
                ladder = self.ladder(quantity, written=written) if quantity.is_measured else None
                if ladder is not None:
                    yield from self._steps(replace(whole, quantity=quantity), ladder)

    def _steps(self, subject: Subject, ladder: Ladder) -> Iterator[Subject]:
        for component in components_of(quantity_of(subject)):
            for direction in self.directions:
                yield from graded(subject, ladder, component + direction)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = quantity_of(subject)
        change = self._change(subject, random)

        async def written(call: Call, proceed: Proceed) -> Reply:
            if quantity.name not in call.values:
                return await proceed(call.as_is(NOT_GIVEN))
            before = call.values[quantity.name]
            value = change(before, call.time)
            why = why_away(quantity, before, value)
            return await proceed(call.as_is(why) if why else call.with_value(quantity, value))

        async def read(call: Call, proceed: Proceed) -> Reply:
            reply = await proceed(call)
            if quantity.name not in reply.values:
                return reply.as_is(NOT_GIVEN)
            before = reply.values[quantity.name]
            value = change(before, call.time)
            why = why_away(quantity, before, value)
            return reply.as_is(why) if why else reply.with_value(quantity, value)

        return written if quantity in subject.written else read

    def _change(
        self, subject: Subject, random: Random
    ) -> Callable[[Value, Callable[[], float]], Value | None]:
        """What makes the new value of each call in turn; None to stay away."""
        draws, size = Draws(random), self.size_of(subject)
        quantity = quantity_of(subject)
        passed = Passed(0, lambda: 0.0, random, is_relative=quantity.mode is Mode.BY)

        def changed(value: Value, time: Callable[[], float]) -> Value | None:
            passed.number += 1
            passed.time, passed.random = time, draws.next()

            def number(before: float) -> float:
                after = self.number(size, before, passed)
                passed.last = after
                return after

            return in_component(quantity, subject.direction, value, number)

        return changed

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        shown = f"{label(quantity)}{_component(subject.direction)}"
        if quantity not in subject.written:
            return f"reads {shown} {self.fault(subject)}"
        return f"{shown} {self.fault(subject)}"

    def fault(self, subject: Subject) -> str:
        """The fault in words, behind the name of the quantity."""
        return signed(subject)


def graded(subject: Subject, ladder: Ladder, direction: str) -> Iterator[Subject]:
    """The subject, once for each magnitude of a ladder in one direction."""
    for size in ladder.steps:
        yield replace(
            subject,
            variant=f"{direction}{amount(size, ladder.unit)}",
            magnitude=size,
            unit=ladder.unit,
            direction=direction,
        )


def amount(size: float, unit: str | None) -> str:
    """A magnitude as ids have it."""
    return f"{size:g}{'%' if unit == 'percent' else unit or ''}"


def signed(subject: Subject) -> str:
    """A magnitude as descriptions have it: ``+ 20 mm``."""
    way = {"+": "+ ", "-": "− "}.get(subject.direction[-1:], "")
    unit = {"percent": " %", None: ""}.get(subject.unit, f" {subject.unit}")
    return f"{way}{subject.magnitude:g}{unit}"


def components_of(quantity: Quantity) -> tuple[str, ...]:
    """The components of which one is changed: indices of a vector, axes of an orientation; else ``""``."""
    if quantity.is_whole:
        return ("x", "y", "z")
    bounds = quantity.path.steps[-1].bounds if quantity.path.steps else None
    if bounds is None:
        return ("",)
    first, last, step = bounds
    count = len(range(first or 0, last, step or 1)) if last is not None and last > 0 else _JOINTS
    return tuple(f"[{index}]" for index in range(count))


def in_component(
    quantity: Quantity, direction: str, value: Value, change: Callable[[float], float]
) -> Value | None:
    """A value with one number of it changed: of an orientation, the angle by which an axis turns it."""
    component = direction.rstrip("+-")
    if quantity.is_whole:
        return _turned(quantity, component, value, change)
    if not component:
        return _like(quantity, value, change(value)) if is_number(value) else None
    index = int(component.strip("[]"))
    try:
        before = value[index]
    except (TypeError, IndexError, KeyError):
        return None
    if not is_number(before):
        return None
    copy = value.copy() if hasattr(value, "copy") else list(value)
    copy[index] = _like(quantity, before, change(float(before)))
    return type(value)(copy) if isinstance(value, tuple) else copy


def _turned(quantity: Quantity, axis: str, value: Value, change: Callable[[float], float]) -> Value | None:
    orientation = quantity.orientation(value)
    if orientation is None:
        return None
    angle = change(0.0)
    radians = convert_difference(angle, quantity.unit or "rad", "rad")
    turn = from_rotation_vector([radians if one == axis else 0.0 for one in "xyz"])
    return quantity.numbers(product(turn, orientation))


def _like(quantity: Quantity, before: Value, after: float) -> float:
    """A count stays a whole number; any other may have parts."""
    if quantity.kind is Kind.COUNT and isinstance(before, int):
        return round(after)
    return after


def _component(direction: str) -> str:
    component = direction.rstrip("+-")
    if not component:
        return ""
    return component if component.startswith("[") else f" about {component}"
