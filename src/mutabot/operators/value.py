"""The shapes of operators that change values of one call, written or read."""

from __future__ import annotations

import re
from abc import abstractmethod
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from random import Random
from typing import Any, ClassVar, TypeVar

from mutabot.model import Call, Kind, Middleware, Operation, Pattern, Proceed, Quantity, Reply
from mutabot.model.quantity import SAME_ORIENTATION, TURNED_ROUND, Value, is_same
from mutabot.model.units import Quaternion, distance, inverse

from .magnitudes import Magnitudes, sized
from .operator import Context, Operator, Subject, Unchanged, quantity_of

CallOrReply = TypeVar("CallOrReply", Call, Reply)
_NAMES = re.compile(r"[._]")
#: why an operator leaves a call alone, or what it reads, that is without its value
NOT_PASSED = "the call passes no plain value here"
NOT_RETURNED = "the call returns no plain value here"
SAME = "the value would stay the same"


class ValuesOperator(Operator):
    """Changes values that a call writes, or values that it reads."""

    variants: ClassVar[Mapping[str, Any]] = {"": None}

    @abstractmethod
    async def changes(self, values: Mapping[str, Value], context: Context) -> Mapping[str, Value]:
        """The values that are others than before, by quantity. Raises Unchanged to leave the call alone.

        ``values`` are those of the side on which the subject's quantity stands. What it may await is
        ``context.call.current``.
        """

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        context = Context(subject, random, self.variants.get(subject.variant))

        async def written(call: Call, proceed: Proceed) -> Reply:
            return await proceed(await self._changed(call, call, context))

        async def read(call: Call, proceed: Proceed) -> Reply:
            return await self._changed(await proceed(call), call, context)

        return written if subject.is_written else read

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        if subject.is_written:
            return f"{label(quantity)} {' → '.join(quantity.texts(before, after))}"
        return f"reads {label(quantity)} {' instead of '.join(quantity.texts(after, before))}"

    def why_unchanged(self, quantity: Quantity, before: Value, after: Value | None) -> str:
        """Why a new value is not put in place of another one; empty if it can be."""
        if after is None:
            return "a value of this type cannot be changed"
        if not _allowed(quantity, after):
            if quantity.range is None:
                return "the vocabulary does not allow the new value"
            return "the value would leave the range [{:g}, {:g}]".format(*quantity.range)
        if is_same(quantity, before, after):
            return SAME
        if quantity.clip is not None and is_same(quantity, quantity.clipped(before), quantity.clipped(after)):
            return "both values are limited to the same one by clip = [{:g}, {:g}]".format(*quantity.clip)
        return ""

    async def _changed(self, one: CallOrReply, call: Call, context: Context) -> CallOrReply:
        """The call, or the reply to it, with the new values in it."""
        context.call = call  # others may have been made while this one waited for its reply
        try:
            changed = await self.changes(one.values, context)
        except Unchanged as why:
            return one.as_is(str(why))
        finally:
            context.let_go(call)
        known = {quantity.name: quantity for quantity in context.subject.side}
        reasons = [self.why_unchanged(known[name], one.values[name], changed[name]) for name in changed]
        serious = [reason for reason in reasons if reason and reason != SAME]
        if serious or all(reasons):
            return one.as_is((serious or [SAME])[0])
        return replace(one, values={**one.values, **changed})


class ValueOperator(ValuesOperator):
    """Changes the value of one quantity.

    Class attributes:
        kinds: the kinds of quantities on which it acts, unless ``fits`` says otherwise.
        of_written, of_read: on which sides it acts.
        variants: a mutant each, with what they mean (``context.option``).
        directions: which ways a fault with magnitudes goes: a ladder each.
    """

    kinds: ClassVar[frozenset[Kind]] = frozenset()
    of_written: ClassVar[bool] = True
    of_read: ClassVar[bool] = True
    directions: ClassVar[tuple[str, ...]] = ("",)

    @abstractmethod
    def change(self, value: Value, context: Context) -> Value | None:
        """The new value, or None if not applicable. Raises Unchanged to leave the value alone."""

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        """Whether the operator has something to say about this quantity of a call."""
        return quantity.kind in self.kinds

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        """The variants for a quantity."""
        return self.variants

    def magnitudes(self, quantity: Quantity) -> Magnitudes | None:
        """How big the fault is to be, a mutant each; None for one without a size, which may have variants."""
        return None

    def directions_of(self, quantity: Quantity) -> Iterable[str]:
        """The directions for a quantity."""
        return self.directions

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        for is_on, side in ((self.of_written, whole.written), (self.of_read, whole.read)):
            for quantity in side if is_on else ():
                if self.fits(quantity, whole):
                    yield from self._subjects_of(quantity, replace(whole, quantity=quantity))

    def _subjects_of(self, quantity: Quantity, subject: Subject) -> Iterator[Subject]:
        ladder = self.magnitudes(quantity)
        if ladder is None:
            yield from (replace(subject, variant=variant) for variant in self.variants_of(quantity))
        else:
            for direction in self.directions_of(quantity):
                yield from sized(subject, ladder, direction)

    async def changes(self, values: Mapping[str, Value], context: Context) -> Mapping[str, Value]:
        name = context.quantity.name
        value = given(values, name, context.subject)
        context.number += 1
        return {name: self.change(value, context)}


def label(quantity: Quantity) -> str:
    """How descriptions call a quantity: its axis where it has one, and its name."""
    name = quantity.name.lstrip(".")
    if quantity.axis is None or quantity.axis in _NAMES.split(name):
        return name
    return f"{name} ({quantity.axis})"


def given(values: Mapping[str, Value], name: str, subject: Subject) -> Value:
    """A value of a call. Raises Unchanged if the call does not give it."""
    if name not in values:
        raise Unchanged(NOT_PASSED if subject.is_written else NOT_RETURNED)
    return values[name]


def _allowed(quantity: Quantity, value: Value) -> bool:
    """Whether the robot API takes the value, or each component of a vector."""
    if hasattr(value, "__len__") and not isinstance(value, str | bytes):
        return all(quantity.allows(item) for item in value)
    return quantity.allows(value)


def the_other_way(quantity: Quantity, value: Value) -> Value | None:
    """The inverse rotation, written like the value; the value itself where that is the same orientation."""
    return turned(quantity, value, inverse, TURNED_ROUND)


def turned(
    quantity: Quantity,
    value: Value,
    change: Callable[[Quaternion], Quaternion],
    least: float = SAME_ORIENTATION,
) -> Value | None:
    """Another orientation, written like the value; the value itself where they are less than that apart."""
    before = quantity.orientation(value)
    if before is None:
        return None
    after = change(before)
    if distance(before, after) < least and not quantity.by_number:
        return value
    parts = iter(quantity.numbers(after))
    return map_numbers(value, lambda _: next(parts) + 0.0)  # no −0


def is_number(value: Value) -> bool:
    """Whether a value is a plain number (numpy scalars included, truth values not)."""
    if isinstance(value, bool) or type(value).__name__ in ("bool_", "bool"):
        return False
    return isinstance(value, int | float) or (hasattr(value, "__float__") and not hasattr(value, "__len__"))


def map_numbers(value: Value, change: Any) -> Value | None:
    """``change`` applied to a number, or to each number of a vector; None where there is none.

    The container's type is kept: lists stay lists, tuples tuples, arrays arrays. An array of whole numbers
    becomes one of floating-point numbers.
    """
    if is_number(value):
        is_unsigned = getattr(getattr(value, "dtype", None), "kind", "") == "u"  # which has no other sign
        return change(int(value) if is_unsigned else value)
    if isinstance(value, list | tuple) and value and all(is_number(item) for item in value):
        return type(value)(change(item) for item in value)
    if isinstance(value, array) and len(value):
        return array(value.typecode if value.typecode in "fd" else "d", [change(item) for item in value])
    if hasattr(value, "dtype") and getattr(value, "ndim", 0) == 1:
        changed = value.copy() if value.dtype.kind == "f" else value.astype(float)
        for index in range(len(changed)):
            changed[index] = change(changed[index])
        return changed
    return None


def next_of(value: Value, quantity: Quantity, by: int = 1) -> Value:
    """The value that comes so many places after another one. Raises Unchanged if it is none of the values."""
    values = quantity.values or ()
    if value not in values:
        raise Unchanged("it is not one of the known values")
    return values[(values.index(value) + by) % len(values)]


def within(value: float, limits: tuple[float, float] | None) -> float:
    """A number, or the end of the limits that is nearest to it."""
    return value if limits is None else min(max(value, limits[0]), limits[1])
