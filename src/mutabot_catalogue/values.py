"""Helpers of several operators: exchanged values, the middle of a range, calls without a request."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from mutabot.api.faults import Context, Subject, Unchanged, ValueOperator
from mutabot.api.values import Operation, Quantity

#: the families of this package's operators
CATALOGUE, MIDDLEWARE = "catalogue", "middleware"


class Exchange(ValueOperator):
    """Exchanges two values of one kind; the variant names the second."""

    family = CATALOGUE

    @abstractmethod
    def pairs(self, whole: Subject) -> Iterable[tuple[Quantity, Quantity]]:
        """Yield the pairs of a call whose values could be exchanged."""

    def subjects(self, whole: Subject) -> Iterator[Subject]:
        for first, second in self.pairs(whole):
            yield replace(whole, quantity=first, variant=second.name.lstrip("."))

    async def changes(self, values: Mapping[str, Any], context: Context) -> Mapping[str, Any]:
        own, partner = context.quantity.name, _other_of(context.subject).name
        first, second = (context.subject.given(values, name) for name in (own, partner))
        return {own: second, partner: first}

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        own, partner = subject.required_quantity, _other_of(subject)
        description = f"{own.label} {own.text(before)} and {partner.label} {partner.text(after)} exchanged"
        return description if subject.is_written else f"reads {description}"


def _other_of(subject: Subject) -> Quantity:
    """Return the second quantity of a pair."""
    name = subject.variant.partition("+")[0]
    return next(quantity for quantity in subject.side if quantity.name.lstrip(".") == name)


def is_alike(first: Quantity, second: Quantity) -> bool:
    """Return whether two quantities have the same meaning, apart from their places."""
    return (first.kind, first.unit, first.mode, first.frame) == (
        second.kind,
        second.unit,
        second.mode,
        second.frame,
    )


def middle_of(quantity: Quantity, share: float) -> tuple[float, float]:
    """Return the ends of the middle share of a quantity's range. Raises Unchanged if it is unknown."""
    limits = quantity.range or quantity.clip
    if limits is None:
        raise Unchanged("the vocabulary gives no range")
    low, high = limits
    cut = (high - low) * (1.0 - share) / 2.0
    return low + cut, high - cut


def like(before: float, after: float) -> float:
    """Return a number, converted to the type of another one if that loses nothing."""
    is_whole = isinstance(before, int) and not isinstance(before, bool) and float(after).is_integer()
    return int(after) if is_whole else after


def comes_by_itself(operation: Operation) -> bool:
    """Return whether the program does not request it, like a message to a callback or a tick."""
    return operation.form is not None and operation.form.comes_by_itself


def within(value: float, limits: tuple[float, float] | None) -> float:
    """Return a number, limited to a range if there is one."""
    return value if limits is None else min(max(value, limits[0]), limits[1])
