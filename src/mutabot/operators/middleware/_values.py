"""Operators of this family that change one value, whichever side it stands on."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Iterator
from random import Random
from typing import Any, ClassVar

from mutabot.families import MIDDLEWARE
from mutabot.model import Call, Kind, Middleware, Operation, Pattern, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.model.values.sameness import is_same
from mutabot.operators.operator import Operator, Subject

NOT_GIVEN = "the call gives no such value"
#: why an operator stays away from what it would set up: a middleware need not have all that others have
NOT_SET = "its middleware has no such setting, or chooses it itself"
_SAME = "the value would stay the same"


class Away(Exception):  # noqa: N818  # no error: a reason
    """Why an operator stays away from a value."""


class ValueOperator(Operator):
    """Changes one written or one read value; ``variants`` are a mutant each."""

    family = MIDDLEWARE
    variants: ClassVar[tuple[str, ...]] = ("",)

    @abstractmethod
    def fits(self, quantity: Quantity) -> bool:
        """Whether the operator has something to say about this quantity."""

    @abstractmethod
    def change(self, subject: Subject, value: Value) -> Value:
        """The new value. Raises Away to leave it alone."""

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        """The variants for a quantity."""
        return self.variants

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        for quantity in (*whole.written, *whole.read):
            if self.fits(quantity):
                for variant in self.variants_of(quantity):
                    yield Subject(operation, pattern, quantity, variant)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = quantity_of(subject)

        async def written(call: Call, proceed: Proceed) -> Reply:
            try:
                return await proceed(call.with_value(quantity, self._changed(subject, call.values)))
            except Away as away:
                return await proceed(call.as_is(str(away)))

        async def read(call: Call, proceed: Proceed) -> Reply:
            reply = await proceed(call)
            try:
                return reply.with_value(quantity, self._changed(subject, reply.values))
            except Away as away:
                return reply.as_is(str(away))

        return written if quantity in subject.written else read

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        one, other = quantity.texts(before, after)
        return f"{quantity.name} {one or '“”'} → {other or '“”'}"

    def _changed(self, subject: Subject, values: Any) -> Value:
        quantity = quantity_of(subject)
        if quantity.name not in values:
            raise Away(NOT_SET if quantity.kind is Kind.SETTING else NOT_GIVEN)
        value = self.change(subject, values[quantity.name])
        if is_same(quantity, value, values[quantity.name]):
            raise Away(_SAME)
        return value


class SettingOperator(ValueOperator):
    """Changes one thing that something is set up with."""

    setting: ClassVar[str]

    def fits(self, quantity: Quantity) -> bool:
        return quantity.kind is Kind.SETTING and quantity.name == self.setting


def quantity_of(subject: Subject) -> Quantity:
    """The subject's quantity; an operator on values never gets a subject without one."""
    assert subject.quantity is not None
    return subject.quantity


def other_of(subject: Subject, value: Value) -> Value:
    """The other of a quantity's two values. Raises Away if the value is neither."""
    values = quantity_of(subject).values or ()
    if value not in values:
        raise Away(f"{value} is neither {' nor '.join(map(str, values))}")
    return values[1 - values.index(value)]
