"""Timelines: the calls and contacts of the original beside those of a mutant, around where they part."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.values.quantity import value_text

from .recording import Recording, Told

#: rows before the first that differs, and after it
_BEFORE, _AFTER = 3, 12
_WORDS = {"touch": "touches", "part": "leaves"}


@frozen
class Entry:
    """Something that was done or happened.

    Attributes:
        time: s; None without a clock.
        text: in words.
    """

    time: float | None
    text: str


@frozen
class Row:
    """The same thing in the original and in the mutant; None where it did not happen.

    Attributes:
        is_fault: whether the mutant changed something here for the first time.
    """

    original: Entry | None
    mutant: Entry | None
    is_fault: bool = False

    @property
    def is_same(self) -> bool:
        """Whether both have it, at the same time."""
        one, other = self.original, self.mutant
        return one is not None and other is not None and _shown(one.time) == _shown(other.time)


def timeline(original: Recording, mutant: Recording) -> list[Row]:
    """All rows, in their order."""
    before, after = entries(original), entries(mutant)
    fault = _fault(mutant)
    rows = []
    for one, other in _side_by_side(before, after):
        rows.append(Row(one, other, fault is not None and other == fault))
    return rows


def around(rows: Sequence[Row]) -> tuple[Sequence[Row], int, int]:
    """The rows around the first that differs, and how many are left out before and after them."""
    first = next((number for number, row in enumerate(rows) if row.is_fault or not row.is_same), len(rows))
    start, end = max(0, first - _BEFORE), min(len(rows), first + _AFTER)
    return rows[start:end], start, len(rows) - end


def entries(recording: Recording) -> list[Entry]:
    """Calls and what happened, in their order."""
    calls = [(one.began, Entry(one.began, call_text(one))) for one in recording.calls]
    if any(began is None for began, _ in calls):
        return [entry for _, entry in calls]
    happened = [(one.time, Entry(one.time, _moment_text(one.what, one.text))) for one in recording.moments]
    # a contact that begins during a call is told after it
    return [entry for _, entry in sorted([*calls, *happened], key=lambda one: one[0] or 0.0)]


def call_text(call: Told) -> str:
    """``move_by y 0.2``, ``position → x 0.1``; beside other values, zeros are left out."""
    name = call.pattern or call.operation.rpartition(":")[2]
    read = f" → {_values(call.read)}" if call.read else ""
    moved = {key: value for key, value in call.written.items() if value or isinstance(value, bool)}
    return f"{name} {_values(moved or call.written)}".rstrip() + read


def _values(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{name.lstrip('.')} {value_text(value)}".strip() for name, value in values.items())


def _moment_text(what: str, text: str) -> str:
    one, _, other = text.partition(", ")
    return f"{one} {_WORDS[what]} {other}" if what in _WORDS else text


def _fault(mutant: Recording) -> Entry | None:
    """The entry of the call that the mutant changed first."""
    number = mutant.faulty_call
    if number is None or number >= len(mutant.calls):
        return None
    faulty = mutant.calls[number]
    return Entry(faulty.began, call_text(faulty))


def _side_by_side(
    before: Sequence[Entry], after: Sequence[Entry]
) -> Iterator[tuple[Entry | None, Entry | None]]:
    matcher = SequenceMatcher(None, [one.text for one in before], [one.text for one in after], autojunk=False)
    for _, i, j, k, m in matcher.get_opcodes():
        if j - i == m - k and [one.text for one in before[i:j]] == [one.text for one in after[k:m]]:
            yield from zip(before[i:j], after[k:m], strict=True)
            continue
        yield from ((one, None) for one in before[i:j])
        yield from ((None, other) for other in after[k:m])


def _shown(time: float | None) -> str:
    return "" if time is None else f"{time:.1f}"
