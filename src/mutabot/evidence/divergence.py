"""The divergence of a mutant's test from the original's: the first moment, how far, and what happened."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, isclose
from typing import Any

from mutabot.model.outcome import Apart, Diverged
from mutabot.model.values.quantity import is_number, told_apart, value_text

from .recording import Told
from .story import story_of
from .tracks import Seen, approaches, differences, noise_of

#: differences and approaches that are told
_MOST = 8
#: by so much may equal numbers of a trace differ, as where no probe has a tolerance
_ROUNDING = 1e-6


def diverged(
    test: str,
    original: Seen,
    mutant: Seen,
    noise: Mapping[str, float] | None = None,
    *,
    is_cut: bool = False,
) -> Diverged | None:
    """How a mutant's test differs from the original's; None if nothing that was recorded does.

    Args:
        test: node id.
        noise: by how much each thing is apart in equal runs of the original.
        is_cut: whether something ended the mutant's test before its end.
    """
    end = mutant.recording.times[-1] if is_cut and mutant.recording.times else inf
    apart = differences(original.paths, mutant.paths, noise, end)
    call = first_difference(original.recording.calls, mutant.recording.calls)
    if not apart and call is None:
        return None
    near = approaches(original.paths, mutant.paths, mutant.recording.blocks)
    at, what = _first(apart, call, original.recording.calls, mutant.recording.calls)
    return Diverged(
        test=test,
        at=at,
        what=what,
        story=story_of(original, mutant, apart, near, is_cut=is_cut),
        apart=tuple(apart[:_MOST]),
        near=tuple(near[:_MOST]),
        fault=mutant.recording.fault,
        is_simulated=mutant.recording.is_simulated and original.recording.is_simulated,
    )


def noise_between(one: Seen, other: Seen) -> dict[str, float]:
    """By how much each thing is apart in two equal runs of the original."""
    return noise_of(one.paths, other.paths)


def first_difference(original: list[Told], mutant: list[Told]) -> int | None:
    """The number of the first call, from 0, that differs; None if they are the same calls."""
    for number, (one, other) in enumerate(zip(original, mutant, strict=False)):
        if not _is_same(one, other):
            return number
    return None if len(original) == len(mutant) else min(len(original), len(mutant))


def _is_same(one: Told, other: Told) -> bool:
    if (one.operation, one.place, one.pattern) != (other.operation, other.place, other.pattern):
        return False
    return _are_equal(one.written, other.written) and _are_equal(one.read, other.read)


def _are_equal(values: Any, others: Any) -> bool:
    """Whether values are equal, numbers up to what rounding does to them."""
    if isinstance(values, Mapping) and isinstance(others, Mapping):
        return values.keys() == others.keys() and all(_are_equal(values[key], others[key]) for key in values)
    if isinstance(values, list | tuple) and isinstance(others, list | tuple):
        return len(values) == len(others) and all(map(_are_equal, values, others))
    if is_number(values) and is_number(others):
        return isclose(values, others, rel_tol=_ROUNDING, abs_tol=_ROUNDING)
    return bool(values == others)


def _first(
    apart: list[Apart], call: int | None, original: list[Told], mutant: list[Told]
) -> tuple[float | None, str]:
    """The first moment at which anything differs, s, and what."""
    found = [(one.first, f"{one.name} is not where it is in the original") for one in apart]
    if call is not None:
        text, time = _call_text(call, original, mutant)
        if time is None:
            return min(found)[0] if found else None, text
        found.append((time, text))
    return min(found)


def _call_text(number: int, original: list[Told], mutant: list[Told]) -> tuple[str, float | None]:
    if number >= len(mutant):
        one = original[number]
        return f"{_name(one)} is not called any more", one.began
    other = mutant[number]
    if number >= len(original):
        return f"{_name(other)} is called once more", other.began
    one = original[number]
    if (one.operation, one.place, one.pattern) != (other.operation, other.place, other.pattern):
        return f"{_name(other)} is called instead of {_name(one)}", other.began
    for before, after, verb in ((one.written, other.written, "sends"), (one.read, other.read, "reads")):
        for name in {**before, **after}:
            if not _are_equal(before.get(name), after.get(name)):
                usual, found = told_apart(before.get(name), after.get(name), value_text, 4)
                return f"{_name(other)} {verb} {name} {found} instead of {usual}", other.began
    return f"{_name(other)} differs", other.began


def _name(call: Told) -> str:
    return f"{call.place} {call.operation.rpartition(':')[2]}"
