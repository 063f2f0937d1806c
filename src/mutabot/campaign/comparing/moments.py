"""At which moments of a test its probes are read along the way: as often as they cost next to nothing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from mutabot.border.events import TestEnd
from mutabot.campaign.request import Progress

#: share of a test's processor time that readings along the way may take, and the seconds that any test may
_SHARE, _LEAST = 0.01, 0.005
#: after every how many commands; a coarser one where this takes too long
_STRIDES = (1, 4, 16, 64)
#: readings before the first thinning inside
_FULL = 100


def strides_of(ends: Mapping[tuple[int, str], TestEnd]) -> dict[tuple[int, str], int]:
    """After every how many commands the probes are read, by round and test; tests without are left out."""
    read = [end for end in ends.values() if end.reading is not None]
    if not read or any(end.not_along for end in ends.values()):
        return {}
    seconds = min(end.reading for end in read if end.reading is not None)
    found = {}
    for key, end in ends.items():
        may_take = max(_LEAST, _SHARE * end.cpu)
        possible = [one for one in _STRIDES if one <= end.commands]
        fitting = [one for one in possible if _readings(end.commands, one) * seconds <= may_take]
        if fitting:
            found[key] = fitting[0]
    return found


def moments_in(strides: Mapping[tuple[int, str], int], round: int) -> dict[str, int]:
    """The strides of a round, by test, for its jobs."""
    return {test: stride for (where, test), stride in strides.items() if where == round}


def note_moments(ends: Iterable[TestEnd], progress: Progress) -> None:
    """Say once why probes are not read along the way."""
    why = next((end.not_along for end in ends if end.not_along), None)
    if why is not None:
        progress.note(f"the probes are read at the ends of tests only, not along the way: {why}")


def _readings(commands: int, stride: int) -> int:
    """About how many readings a test has."""
    moments = commands // stride
    return moments if moments <= _FULL else _FULL + 50 * (moments // _FULL).bit_length()
