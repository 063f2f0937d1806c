"""What happened in a mutant's test that did not in the original: when first, how far, and in a sentence.

Contacts tell the most, where a simulator reports them: what was never touched, what was let go too early,
what was hit, where things lie in the end. Then how far things strayed, and where they ended. A timeline shows
calls and contacts of both beside each other, around where they part.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from math import inf, isclose
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.outcome import Apart, Diverged, Near
from mutabot.model.quantity import is_number, told_apart, value_text

from .recording import Block, Moment, Recording, Told
from .tracks import TURNED, Seen, approaches, differences, noise_of

#: parts of a sentence
_MOST_PARTS = 3
#: seconds by which a contact that ends earlier than in the original is worth telling
_EARLIER = 0.3
#: m: what is nearer than this to something that it does not touch in the original is worth telling
_CLOSE = 0.05
#: s by which a test that ends earlier than in the original is told
_EARLY = 1.0
#: m by which something is let go higher or lower than in the original
_HIGHER = 0.005


def story_of(
    original: Seen, mutant: Seen, apart: Sequence[Apart], near: Sequence[Near], *, is_cut: bool
) -> str:
    """The sentence, its greatest news first; empty if the world was the same.

    ``is_cut``: whether something ended the mutant's test before its end.
    """
    contacts = _Contacts.of(mutant.recording), _Contacts.of(original.recording)
    is_cut = is_cut and contacts[0].end < contacts[1].end - _EARLY
    parts = [
        *(
            [f"the test ended at {contacts[0].end:.1f} s instead of {contacts[1].end:.1f} s"]
            if is_cut
            else []
        ),
        *_never_touched(*contacts),
        *_let_go(*contacts, mutant, original),
        *_hit(*contacts),
        *(_lies_elsewhere(*contacts) if not is_cut else ()),
        *_apart(apart, is_whole=not is_cut),
        *_close(near, contacts[0]),
    ]
    if not parts and apart:
        parts = ["all went the same way, at other times"]
    return "; ".join(list(dict.fromkeys(parts))[:_MOST_PARTS])


class _Contacts:
    """What touched what in a recording, and when."""

    def __init__(self, moments: Sequence[Moment], end: float) -> None:
        self.spans: dict[str, list[tuple[float, float | None]]] = {}
        self.end = end
        for one in moments:
            spans = self.spans.setdefault(one.text, []) if one.what in ("touch", "part") else None
            if spans is None:
                continue
            if one.what == "touch":
                spans.append((one.time, None))
            elif spans and spans[-1][1] is None:
                spans[-1] = (spans[-1][0], one.time)

    @classmethod
    def of(cls, recording: Recording) -> _Contacts:
        return cls(recording.moments, recording.times[-1] if recording.times else 0.0)

    def last_end(self, pair: str) -> float | None:
        """When the two came apart for good; None if they touch to the end, or never did."""
        return self.spans[pair][-1][1] if self.spans.get(pair) else None

    def at_end(self) -> set[str]:
        """The pairs that touch when the test ends."""
        return {pair for pair, spans in self.spans.items() if spans and spans[-1][1] is None}


def _never_touched(mutant: _Contacts, original: _Contacts) -> Iterator[str]:
    for pair in sorted(original.spans.keys() - mutant.spans.keys()):
        began = original.spans[pair][0][0] if original.spans[pair] else mutant.end
        if began < mutant.end:
            one, other = pair.split(", ", 1)
            yield f"{one} and {other} never touched, in the original at {began:.1f} s"


def _let_go(mutant: _Contacts, original: _Contacts, told: Seen, usual: Seen) -> Iterator[str]:
    """Something was held, and came loose otherwise than in the original."""
    for pair in sorted(mutant.spans.keys() & original.spans.keys()):
        if not _is_carried(pair, told):
            continue
        held, holder = _held(pair, told)
        loose, due = mutant.last_end(pair), original.last_end(pair)
        if loose is None:
            if due is not None and due < mutant.end:
                yield f"{held} was never let go by {holder}, in the original at {due:.1f} s"
            continue
        height, name = _height(held, loose, told)
        before = _height(held, due, usual)[0] if due is not None else None
        above = f", {amount(height)} above {name}" if height is not None else ""
        is_meant = due is not None and _calls_at(loose, told) & _calls_at(due, usual)
        if is_meant and height is not None and before is not None and abs(height - before) > _HIGHER:
            yield f"{held} was let go at {loose:.1f} s{above}, in the original {amount(before)}"
        elif not is_meant and loose < (original.end if due is None else due) - _EARLIER:
            yield f"{held} slipped from {holder} at {loose:.1f} s{above}"


def _calls_at(time: float, told: Seen) -> set[str]:
    """The places of the program's calls that were under way, or had just ended."""
    calls = told.recording.calls
    return {
        one.place
        for one in calls
        if one.began is not None and one.ended is not None and one.began <= time <= one.ended + _EARLIER
    }


def _hit(mutant: _Contacts, original: _Contacts) -> Iterator[str]:
    new = [pair for pair in mutant.spans.keys() - original.spans.keys() if mutant.spans[pair]]
    for pair in sorted(new, key=lambda one: mutant.spans[one][0][0]):
        one, other = pair.split(", ", 1)
        yield f"{one} touched {other} at {mutant.spans[pair][0][0]:.1f} s"


def _lies_elsewhere(mutant: _Contacts, original: _Contacts) -> Iterator[str]:
    gone, new = original.at_end() - mutant.at_end(), mutant.at_end() - original.at_end()
    for pair in sorted(gone):
        for other in sorted(new):
            for thing in sorted(set(pair.split(", ")) & set(other.split(", "))):
                yield f"{thing} ended at {_partner(other, thing)} instead of {_partner(pair, thing)}"


def _apart(apart: Sequence[Apart], *, is_whole: bool) -> Iterator[str]:
    for one in apart:
        strayed, final = one.aside or 0.0, one.final if is_whole else 0.0
        if one.is_delay:
            continue
        if one.unit != "m" and final > one.tolerance:
            yield _ended(one.name, final, one.unit)
        elif final > one.tolerance and strayed > 2.0 * final:
            yield f"{one.name} was {amount(strayed)} off its way; ended {amount(final)} away"
        elif final > one.tolerance:
            yield f"{one.name} ended {amount(final)} from where it ends in the original"
        elif strayed > one.tolerance and one.unit == "m":
            yield f"{one.name} was {amount(strayed)} off its way" + (
                ", and ended where it should" if is_whole else ""
            )


def _ended(name: str, final: float, unit: str) -> str:
    thing = name.removesuffix(TURNED)
    if thing != name:
        return f"{thing} ended turned by {amount(final, unit)}"
    return f"{name} ended {amount(final, unit)} off"


def _close(near: Sequence[Near], contacts: _Contacts) -> Iterator[str]:
    for one in near:
        pair = ", ".join(sorted((one.body, one.obstacle)))
        if one.distance < _CLOSE and pair not in contacts.spans:
            yield (
                f"{one.body} came within {amount(one.distance)} of {one.obstacle} at {one.at:.1f} s, "
                f"in the original {amount(one.original)}"
            )


def _is_carried(pair: str, told: Seen) -> bool:
    """Whether one of the two is tracked and the other neither stands around nor is tracked."""
    one, other = pair.split(", ", 1)
    blocks = {block.name for block in told.recording.blocks}
    return (one in told.paths) != (other in told.paths) and not {one, other} & blocks


def _held(pair: str, told: Seen) -> tuple[str, str]:
    one, other = pair.split(", ", 1)
    return (one, other) if one in told.paths else (other, one)


def _height(thing: str, time: float, told: Seen) -> tuple[float | None, str]:
    """How high something was over what stood below it, m, and what that was; None if nothing did."""
    if thing not in told.paths:
        return None, ""
    path = told.paths[thing]
    x, y, z = path.points[max(0, path.at(time) - 1)]  # it falls already in the moment in which it is loose
    half = 0.5 * (path.track.size or (0.0, 0.0, 0.0))[2]
    below = [block for block in told.recording.blocks if _is_over(block, x, y) and _top(block) <= z]
    if not below:
        return None, ""
    highest = max(below, key=_top)
    return max(0.0, z - half - _top(highest)), highest.name


def _is_over(block: Block, x: float, y: float) -> bool:
    return abs(x - block.centre[0]) <= block.size[0] / 2 and abs(y - block.centre[1]) <= block.size[1] / 2


def _top(block: Block) -> float:
    return block.centre[2] + block.size[2] / 2


def _partner(pair: str, thing: str) -> str:
    one, other = pair.split(", ", 1)
    return other if one == thing else one


def amount(value: float, unit: str = "m") -> str:
    """``40 mm``, ``0.31 m``, ``12 deg``."""
    if unit == "m" and value < 0.1:
        millimetres = 1e3 * value if value >= 1e-4 else 0.0
        return f"{millimetres:.0f} mm" if millimetres >= 10.0 else f"{millimetres:.2g} mm"
    return f"{value:.3g} {unit}".strip()


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
