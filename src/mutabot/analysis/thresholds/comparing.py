"""Thresholds of two campaigns beside each other: two suites, or two versions of one."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum

from mutabot.analysis.results import Results
from mutabot.analysis.statistics import Mean, mean_of
from mutabot.frozen import frozen
from mutabot.model.graded import is_same

from .ladders import Ladder, ladders_of
from .rounds import Above, LadderRound


class Change(StrEnum):
    """What became of a ladder: a fact about these rounds, and no test."""

    IMPROVED = "improved"  # worse in no round, better in at least one
    WORSE = "worse"
    MIXED = "mixed"  # both occur
    SAME = "unchanged"
    UNKNOWN = "not compared"  # no round is known in both, or the robot refused


@frozen
class Compared:
    """One ladder in both campaigns.

    Attributes:
        old, new: the ladder.
        steps: per round, by how many steps of the ladder the new suite notices sooner; None where either is
            not known.
    """

    old: Ladder
    new: Ladder
    steps: tuple[float | None, ...]

    @property
    def change(self) -> Change:
        """What became of it."""
        known = [step for step in self.steps if step is not None]
        better, worse = any(step > 0 for step in known), any(step < 0 for step in known)
        if not known:
            return Change.UNKNOWN
        if better and worse:
            return Change.MIXED
        return Change.IMPROVED if better else Change.WORSE if worse else Change.SAME


@frozen
class Comparison:
    """Two campaigns.

    Attributes:
        ladders: those that both have.
        gone, added: ids of ladders that only the old, or only the new one has.
        why_no_words: why single ladders are not said to be improved or worse; empty if they are.
        mean: by how many steps the new suite notices sooner, over all ladders and rounds, with its interval;
            None if there are too few.
    """

    ladders: tuple[Compared, ...]
    gone: tuple[str, ...]
    added: tuple[str, ...]
    why_no_words: str
    mean: Mean | None

    @property
    def has_improved(self) -> bool | None:
        """Whether the interval of the mean is above 0, or below (False); None if it holds 0."""
        if self.mean is None or self.mean.low <= 0.0 <= self.mean.high:
            return None
        return self.mean.low > 0.0


def compare(old: Results, new: Results) -> Comparison:
    """Compare the thresholds of two campaigns, as far as both have the same ladders."""
    before = {one.id: one for one in ladders_of(old)}
    after = {one.id: one for one in ladders_of(new)}
    both = tuple(
        Compared(before[name], one, tuple(_steps(before[name], one))) for name, one in _common(before, after)
    )
    return Comparison(
        ladders=both,
        gone=tuple(name for name in before if name not in after),
        added=tuple(name for name in after if name not in before),
        why_no_words=_why_no_words(old, new),
        mean=mean_of([one.steps for one in both]),
    )


def _common(before: Mapping[str, Ladder], after: Mapping[str, Ladder]) -> Iterator[tuple[str, Ladder]]:
    return ((name, one) for name, one in after.items() if name in before)


def _why_no_words(old: Results, new: Results) -> str:
    seeds = old.meta.get("seed"), new.meta.get("seed")
    if seeds[0] != seeds[1]:
        return f"the seeds differ ({seeds[0]} and {seeds[1]}), so rounds of equal numbers are not alike"
    return ""


def _steps(old: Ladder, new: Ladder) -> Iterator[float | None]:
    """Per round that both have, how many steps sooner the new suite notices."""
    sizes = _together(old.sizes, new.sizes)
    for before, after in zip(old.rounds, new.rounds, strict=False):
        places = _place(before, sizes), _place(after, sizes)
        yield None if None in places else float((places[0] or 0) - (places[1] or 0))


def _together(one: Sequence[float], other: Sequence[float]) -> list[float]:
    """The magnitudes of both, rising, equal ones once: a ladder may have got those of a demand."""
    sizes: list[float] = []
    for size in sorted((*one, *other)):
        if not sizes or not is_same(sizes[-1], size):
            sizes.append(size)
    return sizes


def _place(one: LadderRound, sizes: Sequence[float]) -> int | None:
    """The step from which on a round notices, from 0; one above the top if it never does."""
    if not one.counts or one.above in (Above.REFUSED, Above.NO_EFFECT):
        return None
    if one.bracket.high is None:
        return len(sizes)
    return bisect_left(sizes, one.bracket.high * (1.0 - 1e-9))
