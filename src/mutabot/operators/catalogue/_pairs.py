"""The shape of operators that exchange two values of one call."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from mutabot.model import Operation, Pattern, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators.operator import Subject
from mutabot.operators.robot._values import label, quantity_of

from ._shape import ValuesFault, given, is_written, side_of


class Exchange(ValuesFault):
    """Exchanges two values of one kind; the variant names the second."""

    @abstractmethod
    def pairs(self, whole: Subject) -> Iterable[tuple[Quantity, Quantity]]:
        """The pairs of a call whose values could be exchanged."""

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        for one, other in self.pairs(whole):
            yield replace(whole, quantity=one, variant=other.name.lstrip("."))

    def changed(self, subject: Subject, values: Mapping[str, Value], memory: Any) -> Mapping[str, Value]:
        one, other = quantity_of(subject), other_of(subject)
        first, second = given(values, one.name), given(values, other.name)
        return {one.name: second, other.name: first}

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        one, other = quantity_of(subject), other_of(subject)
        told = f"{label(one)} {one.text(before)} and {label(other)} {other.text(after)} exchanged"
        return told if is_written(subject) else f"reads {told}"


def other_of(subject: Subject) -> Quantity:
    """The second quantity of a pair."""
    name = subject.variant.partition("+")[0]
    return next(one for one in side_of(subject) if one.name.lstrip(".") == name)


def is_alike(one: Quantity, other: Quantity) -> bool:
    """Whether the values of two quantities mean the same, but for where they stand."""
    return (one.kind, one.unit, one.mode, one.frame) == (other.kind, other.unit, other.mode, other.frame)
