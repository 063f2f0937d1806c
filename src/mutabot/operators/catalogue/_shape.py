"""The shape of operators that change values of one call, written or read."""

from __future__ import annotations

import copy
from abc import abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from random import Random
from typing import Any, ClassVar

from mutabot.families import CATALOGUE
from mutabot.model import Call, Middleware, Operation, Pattern, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.operators.operator import Operator, Subject
from mutabot.operators.robot._values import NOT_GIVEN, label, quantity_of, why_away

SAME = "the value would stay the same"


class Away(Exception):  # noqa: N818  # no error: a reason
    """Why an operator stays away from a call."""


class ValuesFault(Operator):
    """Changes values that a call writes, or values that it reads."""

    family = CATALOGUE

    @abstractmethod
    def changed(self, subject: Subject, values: Mapping[str, Value], memory: Any) -> Mapping[str, Value]:
        """The values that are others than before, by quantity. Raises Away to leave the call alone.

        ``values`` are those of the side on which the subject's quantity stands.
        """

    def memory(self, random: Random) -> Any:
        """What it remembers through one test; None if nothing."""
        return None

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        memory = self.memory(random)

        async def written(call: Call, proceed: Proceed) -> Reply:
            try:
                changed = self._checked(subject, call.values, memory)
            except Away as away:
                return await proceed(call.as_is(str(away)))
            return await proceed(replace(call, values={**call.values, **changed}))

        async def read(call: Call, proceed: Proceed) -> Reply:
            reply = await proceed(call)
            try:
                changed = self._checked(subject, reply.values, memory)
            except Away as away:
                return reply.as_is(str(away))
            return replace(reply, values={**reply.values, **changed})

        return written if is_written(subject) else read

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        if is_written(subject):
            return f"{label(quantity)} {' → '.join(quantity.texts(before, after))}"
        return f"reads {label(quantity)} {' instead of '.join(quantity.texts(after, before))}"

    def _checked(self, subject: Subject, values: Mapping[str, Value], memory: Any) -> Mapping[str, Value]:
        changed = self.changed(subject, values, memory)
        quantities = {one.name: one for one in side_of(subject)}
        reasons = [why_away(quantities[name], values[name], value) for name, value in changed.items()]
        serious = [why for why in reasons if why and why != SAME]
        if serious:
            raise Away(serious[0])
        if all(reasons):
            raise Away(SAME)
        return changed


class ValueFault(ValuesFault):
    """Changes the value of one quantity.

    Class attributes:
        variants: a mutant each.
        of_written, of_read: on which sides it acts.
    """

    variants: ClassVar[tuple[str, ...]] = ("",)
    of_written: ClassVar[bool] = True
    of_read: ClassVar[bool] = True

    @abstractmethod
    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        """Whether the operator has something to say about this quantity of a call."""

    @abstractmethod
    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        """The new value; None if it is none that can be changed. Raises Away to leave it alone."""

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        """The variants for a quantity."""
        return self.variants

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        for is_on, side in ((self.of_written, whole.written), (self.of_read, whole.read)):
            for quantity in side if is_on else ():
                if self.fits(quantity, whole):
                    for variant in self.variants_of(quantity):
                        yield replace(whole, quantity=quantity, variant=variant)

    def changed(self, subject: Subject, values: Mapping[str, Value], memory: Any) -> Mapping[str, Value]:
        name = quantity_of(subject).name
        return {name: self.change(subject, given(values, name), memory)}


def is_written(subject: Subject) -> bool:
    """Whether the subject's quantity is one that the call writes."""
    return subject.quantity in subject.written


def side_of(subject: Subject) -> tuple[Quantity, ...]:
    """The quantities of the side on which the subject's quantity stands."""
    return subject.written if is_written(subject) else subject.read


def given(values: Mapping[str, Value], name: str) -> Value:
    """A value of a call. Raises Away if the call does not give it."""
    if name not in values:
        raise Away(NOT_GIVEN)
    return values[name]


def like(before: float, after: float) -> float:
    """A number in the type of the one in whose place it comes, where that loses nothing."""
    is_whole = isinstance(before, int) and not isinstance(before, bool) and float(after).is_integer()
    return int(after) if is_whole else after


def kept(value: Value) -> Value:
    """A value to be remembered: a copy, which nobody changes afterwards."""
    return copy.copy(value) if hasattr(value, "__len__") and not isinstance(value, str | bytes) else value


def middle_of(quantity: Quantity, share: float) -> tuple[float, float]:
    """The ends of the middle share of what a quantity may be. Raises Away if nobody knows its range."""
    limits = quantity.range or quantity.clip
    if limits is None:
        raise Away("the vocabulary gives no range")
    low, high = limits
    cut = (high - low) * (1.0 - share) / 2.0
    return low + cut, high - cut


def within(value: float, limits: tuple[float, float] | None) -> float:
    """A number, or the end of the limits that is nearest to it."""
    return value if limits is None else min(max(value, limits[0]), limits[1])
