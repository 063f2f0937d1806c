"""Demands held against what a campaign found: which sites tolerate more than they may."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from mutabot.errors import unknown_name_text
from mutabot.families import GRADED
from mutabot.frozen import frozen
from mutabot.model import Kind, Outcome, Verdict
from mutabot.model.graded import Demand, MagnitudeResult, is_at_least, is_same, seen
from mutabot.results.ladders import Ladder, LadderRound
from mutabot.results.thresholds import amount, in_rounds

_UNSOUND = {Verdict.UNSTABLE: "is unstable", Verdict.ERROR: "ended in error"}


@frozen
class Ruling:
    """What became of a demand on one ladder.

    Attributes:
        demand: the demand.
        ladder: which; None for a demand that fits none.
        is_met: whether it holds.
        why: in words.
    """

    demand: Demand
    ladder: Ladder | None
    is_met: bool
    why: str

    @property
    def text(self) -> str:
        """``sorting.py:38 arm.move_by y +: survives 5 mm in round 3 (mutant 17)``."""
        where = f"{self.ladder.place} {self.ladder.name}" if self.ladder is not None else "no ladder"
        source = f"{self.demand.source} · " if self.demand.source else ""
        return f"{source}{self.demand.text}: {where}: {self.why}"


def rulings(
    demands: Iterable[Demand], ladders: Sequence[Ladder], families: Iterable[str] = (GRADED,)
) -> tuple[Ruling, ...]:
    """Each demand on each ladder that it speaks of, in their order.

    ``families`` are those that the campaign was asked for.
    """
    families = tuple(families)
    found: list[Ruling] = []
    for demand in demands:
        about = [one for one in ladders if demand.is_about(one.mutant, _kind(one))]
        found += (Ruling(demand, one, *_held(demand, one)) for one in about)
        if not about:
            found.append(Ruling(demand, None, False, _why_nothing_fits(demand, ladders, families)))
    return tuple(found)


def _held(demand: Demand, ladder: Ladder) -> tuple[bool, str]:
    """Whether all rounds notice what is demanded and no valid run of it or more survives; and why."""
    demanded = demand.magnitude_in(ladder.unit)
    assert demanded is not None, "it speaks of ladders of its own measure alone"
    size = amount(demanded, ladder.unit)
    survivors = list(_survivors(ladder, demanded))
    problem = _survivors_text(ladder, survivors) if survivors else _problem(ladder, demanded)
    if problem:
        return False, problem
    ends = [seen(one) for one in _at(ladder, demanded)]
    if MagnitudeResult.NOTICED in ends:
        return True, f"noticed at {size} in {ends.count(MagnitudeResult.NOTICED)} of {len(ends)} rounds"
    if set(ends) == {MagnitudeResult.REFUSED}:
        return True, f"the robot refuses {size}"
    return False, f"{size} has no effect in any round, so nothing is known; demand it of other sites"


def _kind(ladder: Ladder) -> Kind | None:
    return ladder.quantity.kind if ladder.quantity is not None else None


def _why_nothing_fits(demand: Demand, ladders: Sequence[Ladder], families: Sequence[str]) -> str:
    if GRADED not in families:
        return 'the campaign has no graded mutants; add "graded" to families, or run with --family graded'
    if not ladders:
        return "the campaign has no ladders"
    here = [one for one in ladders if demand.is_at(one.mutant)]
    if not here:
        places = {name for one in ladders for name in (one.place, one.mutant.site.id, one.mutant.site.text)}
        return unknown_name_text("site", demand.site or "", places)
    known = ", ".join(sorted({f"{one.name} in {one.unit or 'no unit'}" for one in here}))
    return f"fits none of {len(here)} ladders: {known}"


def _at(ladder: Ladder, demanded: float) -> Iterator[Outcome]:
    """The outcomes at the demanded magnitude."""
    for one in ladder.rounds:
        yield from (outcome for size, outcome in one.outcomes.items() if is_same(size, demanded))


def _survivors(ladder: Ladder, demanded: float) -> Iterator[tuple[LadderRound, float, Outcome]]:
    for one in ladder.rounds:
        for size, outcome in one.outcomes.items():
            if is_at_least(size, demanded) and seen(outcome) is MagnitudeResult.MISSED:
                yield one, size, outcome


def _survivors_text(ladder: Ladder, survivors: Sequence[tuple[LadderRound, float, Outcome]]) -> str:
    unreached = [one.number + 1 for one, _, outcome in survivors if outcome.verdict is Verdict.NOT_COVERED]
    if unreached:
        return f"no test reaches it in {in_rounds(unreached)}"
    largest: dict[float, list[int]] = {}
    for one, size, _ in survivors:
        largest.setdefault(size, []).append(one.number + 1)
    told = [
        f"{amount(size, ladder.unit)} in {in_rounds(numbers)} (mutant {ladder.number_of(size)})"
        for size, numbers in largest.items()
    ]
    return f"survives {', '.join(told)}"


def _problem(ladder: Ladder, demanded: float) -> str:
    """Why nothing can be said in some round; empty if it can in all."""
    size = amount(demanded, ladder.unit)
    if ladder.number_of(demanded) is None:
        return f"{size} is not on its ladder; `mutabot run` again plants it"
    for verdict, words in _UNSOUND.items():
        rounds = [one.number + 1 for one in ladder.rounds if _verdict(one, demanded) is verdict]
        if rounds:
            return f"{size} {words} in {in_rounds(rounds)}"
    missing = [one.number + 1 for one in ladder.rounds if _verdict(one, demanded) is None]
    return f"{size} was not run in {in_rounds(missing)}; `mutabot run` goes on" if missing else ""


def _verdict(one: LadderRound, demanded: float) -> Verdict | None:
    found = (outcome for size, outcome in one.outcomes.items() if is_same(size, demanded))
    return next((outcome.verdict for outcome in found), None)
