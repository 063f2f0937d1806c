"""Find the first call in which a mutant's test differs from the original's."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from math import isclose
from typing import TYPE_CHECKING, Any

from mutabot.model.notation import Notation
from mutabot.model.quantity import distinct_texts, holds_number, is_number, value_text

if TYPE_CHECKING:
    from mutabot.evidence.recording import RecordedCall

#: numbers of calls that differ by less are equal
_ROUNDING = 1e-6


def first_difference(
    original: Sequence[RecordedCall], mutant: Sequence[RecordedCall]
) -> tuple[str, float | None] | None:
    """Describe the first call that differs, and when it began; None if all calls are the same.

    A call that the mutant no longer makes has no time of its own: that is after the last one that it makes.
    """
    for first, second in zip(original, mutant, strict=False):
        found = _difference(first, second)
        if found:
            return found, second.began
    if len(mutant) < len(original):
        first = original[len(mutant)]
        last = mutant[-1] if mutant else first
        return f"{_name(first)} is no longer called", last.began if last.ended is None else last.ended
    if len(original) < len(mutant):
        second = mutant[len(original)]
        return f"{_name(second)} is called once more", second.began
    return None


def what_was_done(calls: Iterable[tuple[Hashable, Any]]) -> frozenset[Any]:
    """Return what was done in a run of a test: its calls, and what they read that is no number.

    Args:
        calls: what identifies each call, and the values that it read, by name or in a fixed order.
    """
    found = set[Any]()
    for call, read in calls:
        values = read.items() if isinstance(read, Mapping) else enumerate(_listed(read))
        found |= {call, *((call, name, str(value)) for name, value in values if not holds_number(value))}
    return frozenset(found)


def _listed(read: Any) -> Sequence[Any]:
    return read if isinstance(read, list | tuple) else ()


def _difference(first: RecordedCall, second: RecordedCall) -> str:
    """Describe how a call differs from the original's; empty if it does not."""
    if (first.operation, first.place, first.pattern) != (second.operation, second.place, second.pattern):
        return f"{_name(second)} is called instead of {_name(first)}"
    for before, after, verb in ((first.written, second.written, "sends"), (first.read, second.read, "reads")):
        for name in {**before, **after}:
            if not _are_equal(before.get(name), after.get(name)):
                usual, found = distinct_texts(before.get(name), after.get(name), value_text, 4)
                return f"{_name(second)} {verb} {name} {found} instead of {usual}"
    return ""


def _are_equal(value: Any, other: Any) -> bool:
    """Return whether values are equal, numbers up to rounding."""
    if isinstance(value, Mapping) and isinstance(other, Mapping):
        return value.keys() == other.keys() and all(_are_equal(value[key], other[key]) for key in value)
    if isinstance(value, list | tuple) and isinstance(other, list | tuple):
        return len(value) == len(other) and all(map(_are_equal, value, other))
    if is_number(value) and is_number(other):
        return isclose(value, other, rel_tol=_ROUNDING, abs_tol=_ROUNDING)
    return bool(value == other)


def _name(call: RecordedCall) -> str:
    command = f" {Notation.compile(call.pattern).short}" if call.pattern is not None else ""
    return f"{call.place} {call.operation.rpartition(':')[2]}{command}"
