"""What several operators share: two values exchanged, the middle of a range, what comes by itself."""

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
        """The pairs of a call whose values could be exchanged."""

    def subjects(self, whole: Subject) -> Iterator[Subject]:
        for one, other in self.pairs(whole):
            yield replace(whole, quantity=one, variant=other.name.lstrip("."))

    async def changes(self, values: Mapping[str, Any], context: Context) -> Mapping[str, Any]:
        one, other = context.quantity.name, _other_of(context.subject).name
        first, second = (context.subject.given(values, name) for name in (one, other))
        return {one: second, other: first}

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        one, other = subject.required_quantity, _other_of(subject)
        told = f"{one.label} {one.text(before)} and {other.label} {other.text(after)} exchanged"
        return told if subject.is_written else f"reads {told}"


def _other_of(subject: Subject) -> Quantity:
    """The second quantity of a pair."""
    name = subject.variant.partition("+")[0]
    return next(one for one in subject.side if one.name.lstrip(".") == name)


def is_alike(one: Quantity, other: Quantity) -> bool:
    """Whether the values of two quantities mean the same, but for where they stand."""
    return (one.kind, one.unit, one.mode, one.frame) == (other.kind, other.unit, other.mode, other.frame)


def middle_of(quantity: Quantity, share: float) -> tuple[float, float]:
    """The ends of the middle share of what a quantity may be. Raises Unchanged if its range is not known."""
    limits = quantity.range or quantity.clip
    if limits is None:
        raise Unchanged("the vocabulary gives no range")
    low, high = limits
    cut = (high - low) * (1.0 - share) / 2.0
    return low + cut, high - cut


def like(before: float, after: float) -> float:
    """A number in the type of the one in whose place it comes, where that loses nothing."""
    is_whole = isinstance(before, int) and not isinstance(before, bool) and float(after).is_integer()
    return int(after) if is_whole else after


def comes_by_itself(operation: Operation) -> bool:
    """Whether the program does not ask for it: a message to a callback, a tick."""
    return operation.form is not None and operation.form.comes_by_itself


def within(value: float, limits: tuple[float, float] | None) -> float:
    """A number, or the end of the limits that is nearest to it."""
    return value if limits is None else min(max(value, limits[0]), limits[1])
