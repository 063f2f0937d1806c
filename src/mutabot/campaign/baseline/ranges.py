"""Recorded values that lie outside the range which the vocabulary gives: mutants stay away from them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from mutabot.border.events import Remark
from mutabot.campaign.request import Progress
from mutabot.model import Operation, Pattern, Quantity, Vocabulary
from mutabot.model.values.quantity import is_number

from .baseline import Baseline


@dataclass(slots=True)
class _Count:
    """How often a quantity had a value, how often one outside its range, and the first of these."""

    values: int = 0
    outside: int = 0
    example: float | None = None

    def add(self, quantity: Quantity, value: Any) -> None:
        numbers = [item for item in _items(value) if is_number(item)]
        beyond = [number for number in numbers if not quantity.allows(number)]
        self.values += bool(numbers)
        self.outside += bool(beyond)
        if self.example is None and beyond:
            self.example = beyond[0]


def note_ranges(baseline: Baseline, vocabulary: Vocabulary, progress: Progress) -> None:
    """Tell once about each quantity whose recorded values leave its own range."""
    remarks = tuple(_out_of_range(baseline, vocabulary))
    baseline.remarks = (*baseline.remarks, *remarks)
    for remark in remarks:
        progress.note(str(remark))


def _out_of_range(baseline: Baseline, vocabulary: Vocabulary) -> Iterator[Remark]:
    for operation in vocabulary.operations:
        for pattern in operation.patterns or (None,):
            owner = pattern if pattern is not None else operation
            for quantity in (*owner.arguments, *owner.result):
                count = _Count()
                if quantity.range is not None:
                    _count(count, baseline, operation, pattern, quantity)
                if count.outside:
                    yield _remark(owner, quantity, count)


def _count(
    count: _Count, baseline: Baseline, operation: Operation, pattern: Pattern | None, quantity: Quantity
) -> None:
    text = pattern.text if pattern is not None else None
    for place, hits in baseline.hits.items():
        if (place.operation, place.pattern) == (operation.target, text):
            for hit in hits:
                count.add(quantity, {**hit.read, **hit.written}.get(quantity.name))


def _remark(owner: Operation | Pattern, quantity: Quantity, count: _Count) -> Remark:
    is_written = quantity in owner.arguments
    limits = "[{:g}, {:g}]".format(*quantity.range or ())
    remedy = f"clip = {limits} if the robot limits what it is sent, else a wider range"
    return Remark(
        owner.source,
        f"{'arguments' if is_written else 'result'}.{quantity.name}",
        f"{count.outside} of {count.values} recorded values are outside range = {limits}, such as "
        f"{quantity.text(count.example)}, and mutants stay away from what is outside; "
        f"give it {remedy if is_written else 'a wider range'}",
    )


def _items(value: Any) -> Sequence[Any]:
    return value if isinstance(value, list | tuple) else [value]
