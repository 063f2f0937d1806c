"""What a campaign in limited time says about all its mutants: an estimate, and what it is an estimate of."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from mutabot.families import GRADED
from mutabot.journal.records import Budgeted
from mutabot.model import By, Mutant, Outcome, Verdict

from .statistics import Interval, stratified

Pair = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Estimate:
    """The score of a family in a role, as far as the time was enough to say something about it.

    Attributes:
        family, role: which.
        score, interval: of all outcomes in classes that were begun; None without a valid one.
        check_score, check_interval: likewise.
        counted: outcomes that it rests on.
        population: outcomes that it speaks about.
        unknown: outcomes in classes that were not begun, of which nothing is said.
    """

    family: str
    role: str
    score: float | None
    interval: Interval | None
    check_score: float | None
    check_interval: Interval | None
    counted: int
    population: int
    unknown: int


def estimates_of(
    budgeted: Budgeted, mutants: Sequence[Mutant], outcomes: Iterable[Outcome]
) -> tuple[Estimate, ...]:
    """One per family and role, in the order in which they first occur in the plan."""
    numbers = {mutant.id: mutant.number for mutant in mutants}
    found = {(numbers[one.mutant], one.round): one for one in outcomes if one.mutant in numbers}
    groups: dict[tuple[str, str], set[int]] = {}
    for mutant in mutants:
        if mutant.family != GRADED:
            groups.setdefault((mutant.family, mutant.site.role.value), set()).add(mutant.number)
    return tuple(_estimate(*key, budgeted, those, found) for key, those in groups.items())


def _estimate(
    family: str, role: str, budgeted: Budgeted, numbers: set[int], found: Mapping[Pair, Outcome]
) -> Estimate:
    done = [pair for pair in budgeted.done if pair[0] in numbers]
    strata: list[tuple[list[Pair], int]] = [(done, len(done))]
    unknown = 0
    for one in budgeted.classes:
        own = [(number, one.round) for number in one.mutants if number in numbers]
        drawn = [(number, one.round) for number in one.mutants[: one.counted] if number in numbers]
        if drawn:
            strata.append((drawn, len(own)))
        else:
            unknown += len(own)

    def estimated(counts: Callable[[Outcome], bool]) -> tuple[float, Interval] | None:
        return stratified(
            [([_cell(found.get(pair), counts) for pair in those], size) for those, size in strata]
        )

    score, check = estimated(lambda one: one.verdict.is_killed), estimated(_is_found)
    return Estimate(
        family,
        role,
        score=score[0] if score is not None else None,
        interval=score[1] if score is not None else None,
        check_score=check[0] if check is not None else None,
        check_interval=check[1] if check is not None else None,
        counted=sum(len(those) for those, _ in strata),
        population=sum(size for _, size in strata),
        unknown=unknown,
    )


def _cell(outcome: Outcome | None, counts: Callable[[Outcome], bool]) -> float | None:
    return float(counts(outcome)) if outcome is not None and outcome.verdict.is_valid else None


def _is_found(outcome: Outcome) -> bool:
    return outcome.verdict is Verdict.KILLED and outcome.by is By.CHECK
