"""Two common shapes of operators: one that changes a written value, one that changes a read value."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Iterable, Iterator
from dataclasses import replace
from random import Random

from mutabot.model import Call, Middleware, Operation, Pattern, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.model.values.sameness import is_same
from mutabot.operators.operator import Operator, Subject

_NAMES = re.compile(r"[._]")
#: why an operator stays away from a call without a value
NOT_GIVEN = "the call gives no such value"
#: why an operator that asks where the robot is stays away
NOT_TOLD = "nothing has told yet where the robot is"


class _ValueOperator(Operator):
    """What both have in common: quantities that fit, each a mutant for every magnitude and variant."""

    @abstractmethod
    def fits(self, quantity: Quantity) -> bool:
        """Whether the operator has something to say about this quantity."""

    @abstractmethod
    def change(self, subject: Subject, value: Value, random: Random) -> Value | None:
        """The new value, or None to stay away.

        The subject tells the quantity, and which variant or magnitude it is where there are several.
        """

    def subjects_of(self, whole: Subject, quantities: Iterable[Quantity]) -> Iterator[Subject]:
        """The operator's subjects among these quantities of a call."""
        for quantity in quantities:
            if not self.fits(quantity):
                continue
            subject = replace(whole, quantity=quantity)
            sizes = self.magnitudes(quantity)
            yield from (replace(subject, variant=f"{size:g}", magnitude=size) for size in sizes)
            if not sizes:
                yield subject


class WrittenValueOperator(_ValueOperator):
    """Changes the value of one written quantity before the robot hears it."""

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        whole = Subject(operation, pattern)
        return self.subjects_of(whole, whole.written)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = quantity_of(subject)

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            if quantity.name not in call.values:
                return await proceed(call.as_is(NOT_GIVEN))
            before = call.values[quantity.name]
            value = self.change(subject, before, random)
            why = why_away(quantity, before, value)
            return await proceed(call.as_is(why) if why else call.with_value(quantity, value))

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        return f"{label(quantity)} {' → '.join(quantity.texts(before, after))}"


class ReadValueOperator(_ValueOperator):
    """Changes the value of one read quantity before the program hears it."""

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        whole = Subject(operation, pattern)
        return self.subjects_of(whole, whole.read)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = quantity_of(subject)

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            reply = await proceed(call)
            if quantity.name not in reply.values:
                return reply.as_is(NOT_GIVEN)
            before = reply.values[quantity.name]
            value = self.change(subject, before, random)
            why = why_away(quantity, before, value)
            return reply.as_is(why) if why else reply.with_value(quantity, value)

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        return f"reads {label(quantity)} {' instead of '.join(quantity.texts(after, before))}"


def quantity_of(subject: Subject) -> Quantity:
    """The subject's quantity; an operator on quantities never gets a subject without one."""
    assert subject.quantity is not None
    return subject.quantity


def label(quantity: Quantity) -> str:
    """How descriptions call a quantity: its axis where it has one, and its name."""
    name = quantity.name.lstrip(".")
    if quantity.axis is None or quantity.axis in _NAMES.split(name):
        return name
    return f"{name} ({quantity.axis})"


def why_away(quantity: Quantity, before: Value, after: Value | None) -> str:
    """Why a new value is not put in place of another one; empty if it can be."""
    if after is None:
        return f"its value is none that {'can be ' if quantity.is_measured else ''}changed"
    if not allowed(quantity, after):
        if quantity.range is None:
            return "the value would be none of those that the vocabulary allows"
        return "the value would leave the range [{:g}, {:g}]".format(*quantity.range)
    if is_same(quantity, before, after):
        return "the value would stay the same"
    if quantity.clip is not None and is_same(quantity, quantity.clipped(before), quantity.clipped(after)):
        return "both values are limited to the same one by clip = [{:g}, {:g}]".format(*quantity.clip)
    return ""


def allowed(quantity: Quantity, value: Value) -> bool:
    """Whether the robot API takes the value, or each component of a vector."""
    if hasattr(value, "__len__") and not isinstance(value, str | bytes):
        return all(quantity.allows(item) for item in value)
    return quantity.allows(value)
