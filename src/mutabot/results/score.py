"""Scores: the share of valid mutants that were killed, always with counts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import field
from statistics import fmean
from typing import TYPE_CHECKING

from mutabot.frozen import frozen
from mutabot.model import By, Mutant, Outcome, Role, Verdict
from mutabot.results.bugs_caught import bugs_caught
from mutabot.results.statistics import Interval, crossed, sampled, wilson

if TYPE_CHECKING:
    from mutabot.journal.records import Drawing


@frozen
class Score:
    """The score of some outcomes, with counts.

    Which verdict stands where in the score is decided in ``model.outcome`` alone.

    Attributes:
        counts: outcomes per verdict; verdicts that did not occur are missing.
        by_check: kills by an assertion of the test or a monitor.
    """

    counts: Mapping[Verdict, int] = field(default_factory=dict)
    by_check: int = 0

    @classmethod
    def of(cls, outcomes: Iterable[Outcome]) -> Score:
        """Return the score of these outcomes."""
        outcomes = list(outcomes)
        return cls(Counter(outcome.verdict for outcome in outcomes), sum(map(_is_found, outcomes)))

    @property
    def of_each(self) -> dict[Verdict, int]:
        """Outcomes per verdict, including verdicts that did not occur."""
        return {verdict: self.counts.get(verdict, 0) for verdict in Verdict}

    @property
    def valid(self) -> int:
        """The denominator."""
        return sum(count for verdict, count in self.counts.items() if verdict.is_valid)

    @property
    def killed(self) -> int:
        """The numerator of the score; it includes time-outs, which are also shown separately."""
        return sum(count for verdict, count in self.counts.items() if verdict.is_killed)

    @property
    def timeouts(self) -> int:
        """The part of ``killed`` that only ran out of its budget."""
        return self.counts.get(Verdict.TIMEOUT, 0)

    @property
    def score(self) -> float | None:
        """Killed / valid, 0 … 1; None if no outcome is valid."""
        return self.killed / self.valid if self.valid else None

    @property
    def check_score(self) -> float | None:
        """Killed by a check / valid, 0 … 1; None if no outcome is valid."""
        return self.by_check / self.valid if self.valid else None

    @property
    def interval(self) -> Interval | None:
        """Wilson's interval of the score of one mutant, over rounds; None with fewer than two."""
        return wilson(self.killed, self.valid) if self.valid > 1 else None


@frozen
class RoundScores:
    """The scores of a group of mutants, round by round.

    Attributes:
        rounds: one score per round.
        interval, check_interval: of the mean score and of the mean check score, over rounds and mutants; None
            with fewer than two rounds or two mutants that were valid.
        accepted: number of accepted survivors, which are in no score.
        sample_interval, sample_check_interval: of the scores that all mutants would have had in these rounds,
            where only a sample of them was run; None if all were, or if fewer than two were valid.
    """

    rounds: tuple[Score, ...]
    interval: Interval | None = None
    check_interval: Interval | None = None
    sample_interval: Interval | None = None
    sample_check_interval: Interval | None = None
    accepted: int = 0

    @classmethod
    def of(
        cls,
        outcomes: Iterable[Outcome],
        rounds: int,
        *,
        population: int | None = None,
        accepted: Collection[str] = (),
    ) -> RoundScores:
        """Return the scores of these outcomes in rounds 0 … ``rounds`` − 1.

        Args:
            outcomes: of any mutants.
            rounds: number of rounds.
            population: how many mutants those that were run are a random sample of; None if they are all.
            accepted: ids of accepted survivors: their outcomes do not count.
        """
        ignored: set[str] = set()
        by_round: list[list[Outcome]] = [[] for _ in range(rounds)]
        by_mutant: dict[str, list[Outcome | None]] = {}
        for outcome in outcomes:
            row = by_mutant.setdefault(outcome.mutant, [None] * rounds)
            if outcome.mutant in accepted:
                ignored.add(outcome.mutant)
            else:
                by_round[outcome.round].append(outcome)
                row[outcome.round] = outcome
        rows = by_mutant.values()
        killed = [
            [_share(outcome, lambda scored: scored.verdict.is_killed) for outcome in row] for row in rows
        ]
        found = [[_share(outcome, _is_found) for outcome in row] for row in rows]
        return cls(
            tuple(map(Score.of, by_round)),
            crossed(killed),
            crossed(found),
            sampled(killed, population) if population is not None else None,
            sampled(found, population) if population is not None else None,
            len(ignored),
        )

    @property
    def total(self) -> Score:
        """The score of all rounds; its counts are of (mutant, round) pairs."""
        counts: Counter[Verdict] = Counter()
        for score in self.rounds:
            counts.update(score.counts)
        return Score(counts, sum(score.by_check for score in self.rounds))

    @property
    def mean(self) -> float | None:
        """Mean of the scores of rounds with a valid mutant; None if there is none."""
        return _mean([score.score for score in self.rounds])

    @property
    def mean_check(self) -> float | None:
        """Mean of the check scores of rounds with a valid mutant; None if there is none."""
        return _mean([score.check_score for score in self.rounds])


@frozen
class Group:
    """The scores of one family in one role. Groups are never combined into one score.

    Attributes:
        family: the operators' family.
        role: ``program`` or ``oracle``.
        mutants: number of planned mutants.
        scores: round by round.
        population: number of mutants that these are a random sample of; None if they are all.
    """

    family: str
    role: str
    mutants: int
    scores: RoundScores
    population: int | None = None

    @property
    def bugs_caught(self) -> str | None:
        """What suites with such a score caught of real bugs, in a sentence; None where that is not known."""
        if self.role != Role.PROGRAM.value:
            return None
        valid = max((score.valid for score in self.scores.rounds), default=0)
        return bugs_caught(self.family, self.scores.mean, valid)


def groups_of(
    mutants: Sequence[Mutant],
    outcomes: Iterable[Outcome],
    rounds: int,
    drawing: Drawing | None = None,
    *,
    accepted: Collection[str] = (),
) -> tuple[Group, ...]:
    """Return one group per family and role, in the order in which they first occur in the plan.

    Graded mutants have none: the magnitudes of a ladder are no population of faults.
    ``drawing`` says how the mutants were drawn, if they were. ``accepted``: as in ``RoundScores.of``.
    """
    key_of = {
        mutant.id: (mutant.family, mutant.site.role.value) for mutant in mutants if not mutant.has_sizes
    }
    sizes = Counter(key_of.values())
    found: dict[tuple[str, str], list[Outcome]] = {key: [] for key in key_of.values()}
    for outcome in outcomes:
        if outcome.mutant in key_of:
            found[key_of[outcome.mutant]].append(outcome)
    groups = []
    for (family, role), those in found.items():
        stratum = drawing.stratum(family, role) if drawing is not None else None
        population = stratum.population if stratum is not None else None
        scores = RoundScores.of(those, rounds, population=population, accepted=accepted)
        groups.append(Group(family, role, sizes[family, role], scores, population))
    return tuple(groups)


def _mean(scores: Sequence[float | None]) -> float | None:
    known = [score for score in scores if score is not None]
    return fmean(known) if known else None


def _is_found(outcome: Outcome) -> bool:
    """Return whether a check killed it."""
    return outcome.verdict is Verdict.KILLED and outcome.by is By.CHECK


def _share(outcome: Outcome | None, counts: Callable[[Outcome], bool]) -> float | None:
    """Return an outcome's cell in the table for intervals: 1, 0, or None outside the score."""
    return float(counts(outcome)) if outcome is not None and outcome.verdict.is_valid else None


def percent(share: float | None) -> str:
    """Return a score as text: ``92.3 %``, or ``–`` where nothing was valid."""
    return "–" if share is None else f"{100 * share:.1f} %"
