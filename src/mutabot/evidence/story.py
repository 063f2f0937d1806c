"""What happened in a mutant's test that did not in the original: one sentence made from events and paths.

Contacts tell the most, where a simulator reports them: what was never touched, what was let go too early,
what was hit, where things lie in the end. Then how far things strayed, and where they ended.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mutabot.model.outcome import Apart, Near

from .recording import Block, Moment, Recording
from .tracks import TURNED, Seen

#: parts of a sentence
_MOST = 3
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
    return "; ".join(list(dict.fromkeys(parts))[:_MOST])


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
