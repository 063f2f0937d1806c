"""Describe what happened in a mutant's test but not in the original: when first, how far, and in a sentence.

Contacts come first, where a simulator reports them; then how far things left their paths, and where they
ended.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf, isclose
from typing import Any

from mutabot.model.outcome import Apart, Diverged
from mutabot.model.quantity import distinct_texts, is_number, value_text

from .recording import RecordedCall, Recording
from .tracks import TURNED, RecordedPaths, differences

#: parts of a sentence, and differences that are kept
_MOST_PARTS, _MOST = 3, 8
#: s by which two things must separate earlier than in the original, and by which a test must end earlier
_EARLIER, _EARLY = 0.3, 1.0
#: numbers of calls that differ by less are equal
_ROUNDING = 1e-6


def diverged(
    test: str,
    original: RecordedPaths,
    mutant: RecordedPaths,
    noise: Mapping[str, float] | None = None,
    *,
    is_cut: bool = False,
) -> Diverged | None:
    """Return how a mutant's test differs from the original's; None if nothing recorded differs.

    Args:
        test: node id.
        noise: by how much each thing is apart in equal runs of the original.
        is_cut: whether something ended the mutant's test before its end.
    """
    end = mutant.recording.times[-1] if is_cut and mutant.recording.times else inf
    apart = differences(original.paths, mutant.paths, noise or {}, end)
    found = [(one.first, f"{one.name} is at a different position than in the original run") for one in apart]
    call = _first_call(original.recording.calls, mutant.recording.calls)
    if call is not None and call[1] is not None:
        found.append((call[1], call[0]))
    if not found and call is None:
        return None
    at, what = min(found) if found else (None, "")
    if call is not None and call[1] is None:  # without a clock calls are all that has an order
        what = call[0]
    return Diverged(
        test=test,
        at=at,
        what=what,
        story=_story(original, mutant, apart, is_cut=is_cut),
        apart=tuple(apart[:_MOST]),
        fault=mutant.recording.fault,
        is_simulated=mutant.recording.is_simulated and original.recording.is_simulated,
    )


def _story(original: RecordedPaths, mutant: RecordedPaths, apart: Sequence[Apart], *, is_cut: bool) -> str:
    """The sentence, most important part first; empty if the world was the same."""
    usual, contacts = contacts_in(original.recording), contacts_in(mutant.recording)
    end, due = (one.recording.times[-1] if one.recording.times else 0.0 for one in (mutant, original))
    is_cut = is_cut and end < due - _EARLY
    parts = [f"the test ended at {end:.1f} s instead of {due:.1f} s"] if is_cut else []
    parts += _contacts(usual, contacts, mutant, end)
    parts += [part for one in apart if not one.is_delay and (part := _strayed(one, is_whole=not is_cut))]
    if not parts and apart:
        parts = ["the same movements happened at other times"]
    return "; ".join(list(dict.fromkeys(parts))[:_MOST_PARTS])


#: two bodies that touch each other, sorted
_Pair = tuple[str, ...]


def contacts_in(recording: Recording) -> dict[_Pair, tuple[float, float | None]]:
    """When two bodies touched first, and when they separated for good; None if they touch at the end."""
    found: dict[_Pair, tuple[float, float | None]] = {}
    for one in recording.moments:
        pair = tuple(one.text.split(", ", 1))
        if one.what == "touch":
            found[pair] = (found[pair][0] if pair in found else one.time, None)
        elif one.what == "part" and pair in found:
            found[pair] = (found[pair][0], one.time)
    return found


def _contacts(
    usual: Mapping[_Pair, tuple[float, float | None]],
    contacts: Mapping[_Pair, tuple[float, float | None]],
    mutant: RecordedPaths,
    end: float,
) -> Iterator[str]:
    """What never touched, what separated at another time, and what touched in the mutant alone."""
    for pair in sorted(usual.keys() - contacts.keys()):
        if usual[pair][0] < end:
            yield f"{pair[0]} and {pair[1]} never touched (original: at {usual[pair][0]:.1f} s)"
    for pair in sorted(usual.keys() & contacts.keys()):
        due, apart = usual[pair][1], contacts[pair][1]
        if not _is_held(pair, mutant):
            continue
        if apart is None and due is not None and due < end:
            yield f"{pair[0]} and {pair[1]} never separated (original: at {due:.1f} s)"
        elif apart is not None and apart < (inf if due is None else due) - _EARLIER:
            original = "never" if due is None else f"at {due:.1f} s"
            yield f"{pair[0]} and {pair[1]} separated at {apart:.1f} s (original: {original})"
    for pair in sorted(contacts.keys() - usual.keys(), key=lambda one: contacts[one]):
        yield f"{pair[0]} touched {pair[1]} at {contacts[pair][0]:.1f} s"


def _is_held(pair: _Pair, seen: RecordedPaths) -> bool:
    """Whether one of the two is tracked and the other neither stands still nor is tracked."""
    fixed = {block.name for block in seen.recording.blocks}
    return len(seen.paths.keys() & set(pair)) == 1 and fixed.isdisjoint(pair)


def _strayed(one: Apart, *, is_whole: bool) -> str:
    """How far one thing was from its path, and where it ended; empty if by no more than its tolerance."""
    strayed, final = one.aside or 0.0, one.final if is_whole else 0.0
    left = f"{one.name} left its path by up to {amount(strayed)}"
    if final > one.tolerance:
        thing = one.name.removesuffix(TURNED)
        if thing != one.name:
            return f"{thing} ended turned by {amount(final, one.unit)}"
        if one.unit != "m":
            return f"{one.name} ended {amount(final, one.unit)} from its value in the original"
        if strayed > 2.0 * final:
            return f"{left} and ended {amount(final)} from its original position"
        return f"{one.name} ended {amount(final)} from its position in the original"
    if strayed <= one.tolerance or one.unit != "m":
        return ""
    return f"{left}{' but reached the correct end position' if is_whole else ''}"


def amount(value: float, unit: str = "m") -> str:
    """``40 mm``, ``0.31 m``, ``12 deg``."""
    if unit == "m" and value < 0.1:
        millimetres = 1e3 * value if value >= 1e-4 else 0.0
        return f"{millimetres:.0f} mm" if millimetres >= 10.0 else f"{millimetres:.2g} mm"
    return f"{value:.3g} {unit}".strip()


def _first_call(
    original: Sequence[RecordedCall], mutant: Sequence[RecordedCall]
) -> tuple[str, float | None] | None:
    """The first call that differs, in words, and when it began; None if all calls are the same."""
    for one, other in zip(original, mutant, strict=False):
        found = _difference(one, other)
        if found:
            return found, other.began
    if len(mutant) < len(original):
        one = original[len(mutant)]
        return f"{_name(one)} is no longer called", one.began
    if len(original) < len(mutant):
        other = mutant[len(original)]
        return f"{_name(other)} is called once more", other.began
    return None


def _difference(one: RecordedCall, other: RecordedCall) -> str:
    """How a call differs from the original's; empty if it does not."""
    if (one.operation, one.place, one.pattern) != (other.operation, other.place, other.pattern):
        return f"{_name(other)} is called instead of {_name(one)}"
    for before, after, verb in ((one.written, other.written, "sends"), (one.read, other.read, "reads")):
        for name in {**before, **after}:
            if not _are_equal(before.get(name), after.get(name)):
                usual, found = distinct_texts(before.get(name), after.get(name), value_text, 4)
                return f"{_name(other)} {verb} {name} {found} instead of {usual}"
    return ""


def _are_equal(value: Any, other: Any) -> bool:
    """Whether values are equal, numbers up to rounding."""
    if isinstance(value, Mapping) and isinstance(other, Mapping):
        return value.keys() == other.keys() and all(_are_equal(value[key], other[key]) for key in value)
    if isinstance(value, list | tuple) and isinstance(other, list | tuple):
        return len(value) == len(other) and all(map(_are_equal, value, other))
    if is_number(value) and is_number(other):
        return isclose(value, other, rel_tol=_ROUNDING, abs_tol=_ROUNDING)
    return bool(value == other)


def _name(call: RecordedCall) -> str:
    return f"{call.place} {call.operation.rpartition(':')[2]}"
