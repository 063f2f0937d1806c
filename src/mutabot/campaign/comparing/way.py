"""Comparing probes along the way of a test: at moments that mutant and original have in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from mutabot.frozen import frozen

#: differences of two readings, each with its distance, greatest first
Differences = Callable[[Mapping[str, Any], Mapping[str, Any]], Sequence[tuple[float, str]]]


class Called(Protocol):
    """One call of a trace."""

    @property
    def key(self) -> str:
        """Where and what."""


class Seen(Protocol):
    """What is needed of a test."""

    @property
    def events(self) -> Sequence[Called]:
        """The calls in order."""

    @property
    def moments(self) -> Sequence[Any] | None:
        """As in ``TestEnd.moments``; None if they are not to be compared."""


@frozen
class Way:
    """How far the way of a mutant's test is from the original's.

    Attributes:
        distance: the greatest difference, in multiples of its probe's tolerance; None if there is nothing to
            compare.
        line: that difference in words, with the call after which it was seen.
        count: moments that were compared.
    """

    distance: float | None = None
    line: str = ""
    count: int = 0


def compare_moments(original: Seen, mutant: Seen, differences: Differences) -> Way:
    """Compare readings after the same calls, as far as both made the same calls."""
    before, after = _readings(original.moments or ()), _readings(mutant.moments or ())
    same = _same_calls(original, mutant)
    common = [call for call in before if call in after and call <= same]
    if not common:
        return Way()
    worst, line = 0.0, ""
    for call in common:
        if before[call] == after[call]:
            continue
        for distance, text in differences(before[call], after[call])[:1]:
            if distance > worst:
                worst = distance
                line = f"on the way, after call {call}, {mutant.events[call - 1].key}: {text}"
    return Way(worst, line, len(common))


def _same_calls(original: Seen, mutant: Seen) -> int:
    """How many calls at the beginning are the same."""
    for number, (before, after) in enumerate(zip(original.events, mutant.events, strict=False)):
        if before.key != after.key:
            return number
    return min(len(original.events), len(mutant.events))


def _readings(moments: Sequence[Any]) -> dict[int, dict[str, Any]]:
    """All parts at each moment; a trace that is cut off has its last number more than once."""
    found: dict[int, dict[str, Any]] = {}
    last: dict[str, Any] = {}
    for call, parts, is_whole in moments:
        last = dict(parts) if is_whole else {**last, **parts}
        found.setdefault(call, last)
    return found
