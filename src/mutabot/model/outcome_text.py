"""Outcomes as texts, and whether two of them say the same."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import groupby
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mutabot.model.outcome import Outcome

#: parts of a message that differ between equal runs in different processes: addresses, temporary folders,
#: and the last words of a process that died, which only a process of its own can have
_ACCIDENTAL = (
    (re.compile(r"0x[0-9a-fA-F]{6,}"), "0x…"),
    (re.compile(r"pytest-\d+"), "pytest-…"),
    (re.compile(r"; it said last: .*", re.DOTALL), ""),
)


def same_end(first: Outcome, second: Outcome) -> bool:
    """Return whether two outcomes have the same verdict, cause, test and message."""
    return _end(first) == _end(second)


def outcome_text(outcome: Outcome) -> str:
    """Return how a mutant ended: ``killed by check in tests/test_box.py::test_arrives: assert 1 == 2``."""
    has_message = bool((outcome.message or "").strip())
    return f"{describe_end(outcome)}: {first_line(outcome.message)}" if has_message else describe_end(outcome)


def first_line(text: str | None) -> str:
    """Return the first line of a message, or a placeholder for an empty message."""
    lines = (text or "").strip().splitlines()
    return lines[0] if lines else "no message"


def describe_end(outcome: Outcome) -> str:
    """Describe how the test ended, without the message."""
    by = f" by {outcome.by}" if outcome.by is not None else ""
    test = f" in {outcome.test}" if outcome.test is not None else ""
    return f"{outcome.verdict}{by}{test}"


def without_accidents(message: str | None) -> str | None:
    """Return a message without parts that differ between equal runs in different processes."""
    for pattern, text in _ACCIDENTAL if message is not None else ():
        message = pattern.sub(text, message or "")
    return message


def _end(outcome: Outcome) -> tuple[Any, ...]:
    return outcome.verdict, outcome.by, outcome.test, without_accidents(outcome.message)


def numbers_text(numbers: Iterable[int]) -> str:
    """Return ``round 3``, ``rounds 1 and 2``, ``rounds 1 and 3 to 5``."""
    runs: list[str] = []
    for _, group in groupby(enumerate(sorted({*numbers})), key=lambda pair: pair[1] - pair[0]):
        run = [number for _, number in group]
        runs += [f"{run[0]} to {run[-1]}"] if len(run) > 2 else map(str, run)
    *others, last = runs
    text = f"{', '.join(others)} and {last}" if others else last
    return f"{'round' if text.isdigit() else 'rounds'} {text}"
