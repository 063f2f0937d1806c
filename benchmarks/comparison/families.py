"""Families side by side: what each costs, what becomes of its mutants, and what they can tell.

Roles are held apart as in scores: a family has a column for each role in which it has mutants.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mutabot.journal.records import Drawing
from mutabot.model import Outcome, Role
from mutabot.results.results import MutantResult, Results
from mutabot.results.score import RoundScores
from mutabot.results.statistics import Interval, crossed, wilson

from .ends import End, Properties, end_of, properties_of
from .subsumption import Redundancy

_BROKEN = frozenset({End.INVALID, End.BEFORE})
_IMPOSSIBLE = frozenset({End.REFUSED, End.GUARDED})
_NO_DIFFERENCE = frozenset({End.NO_EFFECT, End.INDISTINGUISHABLE})
#: ends that speak of one weakness, as the published study names them, and of any
WEAKNESSES: Mapping[str, frozenset[End]] = {
    "broken": _BROKEN,
    "impossible": _IMPOSSIBLE,
    "no_difference": _NO_DIFFERENCE,
    "any": _BROKEN | _IMPOSSIBLE | _NO_DIFFERENCE,
}
FamilyRole = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Share:
    """How many of a number of things are of a kind.

    Attributes:
        count: how many are known to be.
        of: how many there are.
        unknown: of how many it is not known; ``count`` is then the least number.
        interval: of the share, over other mutants (and rounds) like these; None if nothing tells, or where
            some are unknown.
    """

    count: int
    of: int
    unknown: int = 0
    interval: Interval | None = None

    @property
    def share(self) -> float | None:
        """Count / of, 0 … 1; None where there is nothing or some are unknown."""
        return self.count / self.of if self.of and not self.unknown else None

    @classmethod
    def of_mutants(cls, answers: Iterable[bool | None]) -> Share:
        """Of mutants, each counted once; the interval is Wilson's."""
        answers = list(answers)
        count, unknown = answers.count(True), answers.count(None)
        interval = wilson(count, len(answers)) if len(answers) > 1 and not unknown else None
        return cls(count, len(answers), unknown, interval)


@dataclass(frozen=True, slots=True)
class Cost:
    """What the mutants of a family cost, over all rounds, without the baseline and the controls.

    Attributes:
        wall: seconds from the start of each process to its end, added up over processes.
        cpu: processor seconds of the tests.
        simulated: simulated seconds of the tests; None without a clock.
        shared: how many of these were inherited from the original's run and not simulated again.
    """

    wall: float
    cpu: float
    simulated: float | None
    shared: float

    @classmethod
    def of(cls, outcomes: Collection[Outcome]) -> Cost:
        """That of these outcomes."""
        simulated = [outcome.simulated for outcome in outcomes if outcome.simulated is not None]
        return cls(
            wall=math.fsum(outcome.wall for outcome in outcomes),
            cpu=math.fsum(outcome.cpu for outcome in outcomes),
            simulated=math.fsum(simulated) if simulated else None,
            shared=math.fsum(outcome.shared or 0.0 for outcome in outcomes),
        )


@dataclass(frozen=True, slots=True)
class Family:
    """One family in one role.

    Attributes:
        name, role: which.
        mutants: number of mutants that were to be run.
        places: number of sites at which they stand.
        planned: number of (mutant, round) pairs; of these, ``done`` have an outcome.
        cost: of these outcomes.
        ends: share of each end among these outcomes; every end is there.
        weaknesses: share of the outcomes that end in one of several ways, see ``WEAKNESSES``.
        scores: round by round; with the intervals for all mutants where only a sample was run.
        without_oracle: the scores when every assertion is switched off; None if that was not run.
        population: number of mutants that these are a random sample of; None if they are all.
        valid: mutants that stood in the score in some round.
        reached: mutants that a test judged in some round.
        trivial: mutants that every test that reaches them noticed.
        indistinguishable: mutants that no test could have told from the original.
        informative: mutants that are valid, not trivial, not indistinguishable.
        redundancy: within the family.
        joint: classes among the dominators of all families together that hold a mutant of this one.
        alone: how many of these hold no mutant of any other.
    """

    name: str
    role: str
    mutants: int
    places: int
    planned: int
    done: int
    cost: Cost
    ends: Mapping[End, Share]
    weaknesses: Mapping[str, Share]
    scores: RoundScores
    without_oracle: RoundScores | None
    population: int | None
    valid: Share
    reached: Share
    trivial: Share
    indistinguishable: Share
    informative: Share
    redundancy: Redundancy
    joint: int
    alone: int


@dataclass(frozen=True, slots=True)
class FamilyComparison:
    """Families side by side.

    Attributes:
        meta: what the campaign said about itself.
        state: how it ended, as in ``Results``.
        rounds: number of rounds.
        families: one per family and role; a family without a mutant is there as well.
        redundancy: of all families together.
        drawing: how the mutants were drawn; None if all were run.
        properties: of each mutant, by id.
        results: what the campaign found.
    """

    meta: Mapping[str, Any]
    state: str
    rounds: int
    families: tuple[Family, ...]
    redundancy: Redundancy
    drawing: Drawing | None
    properties: Mapping[str, Properties]
    results: Results


def compare_families(results: Results, without_oracle: Results | None = None) -> FamilyComparison:
    """The comparison of all families in a campaign; ``without_oracle`` is another, of the same mutants."""
    joint = Redundancy.of({result.mutant.id: result.outcomes for result in results.mutants})
    homes = {result.mutant.id: _key(result) for result in results.mutants}
    classes = [{homes[mutant] for mutant in members} for members in joint.dominators]
    properties = {result.mutant.id: properties_of(result.rounds) for result in results.mutants}
    scores = {(group.family, group.role): group for group in results.groups}
    others = (
        {(group.family, group.role): group.scores for group in without_oracle.groups}
        if without_oracle
        else {}
    )

    def family(key: FamilyRole) -> Family:
        members = [result for result in results.mutants if _key(result) == key]
        group = scores.get(key)
        return _family(
            key,
            members,
            properties,
            rounds=results.rounds,
            scores=group.scores if group is not None else RoundScores.of([], results.rounds),
            population=group.population if group is not None else None,
            without_oracle=others.get(key),
            homes=[members_of_class for members_of_class in classes if key in members_of_class],
        )

    return FamilyComparison(
        meta=results.meta,
        state=results.state,
        rounds=results.rounds,
        families=tuple(family(key) for key in _keys(results)),
        redundancy=joint,
        drawing=results.drawing,
        properties=properties,
        results=results,
    )


def _keys(results: Results) -> list[FamilyRole]:
    """Families in the order in which they were asked for, those without mutants too; the program first."""
    found = {_key(result) for result in results.mutants}
    asked = results.meta.get("families") or ()
    names = dict.fromkeys([*asked, *(result.mutant.family for result in results.mutants)])
    keys: list[FamilyRole] = []
    for name in names:
        roles = [role for role in Role if (name, role.value) in found]
        keys += [(name, role.value) for role in roles or [Role.PROGRAM]]
    return keys


def _key(result: MutantResult) -> FamilyRole:
    return result.mutant.family, result.mutant.site.role.value


def _family(
    key: FamilyRole,
    members: Sequence[MutantResult],
    properties: Mapping[str, Properties],
    *,
    rounds: int,
    scores: RoundScores,
    population: int | None,
    without_oracle: RoundScores | None,
    homes: Sequence[set[FamilyRole]],
) -> Family:
    outcomes = [outcome for member in members for outcome in member.outcomes]
    ends = [
        [end_of(outcome) if outcome is not None else None for outcome in member.rounds] for member in members
    ]
    own = [properties[member.mutant.id] for member in members]
    return Family(
        name=key[0],
        role=key[1],
        mutants=len(members),
        places=len({member.mutant.site for member in members}),
        planned=len(members) * rounds,
        done=len(outcomes),
        cost=Cost.of(outcomes),
        ends={end: _share_of_outcomes(ends, {end}) for end in End},
        weaknesses={name: _share_of_outcomes(ends, those) for name, those in WEAKNESSES.items()},
        scores=scores,
        without_oracle=without_oracle,
        population=population,
        valid=_share_of_mutants(own, lambda facts: facts.valid),
        reached=_share_of_mutants(own, lambda facts: facts.reached),
        trivial=_share_of_mutants(own, lambda facts: facts.trivial),
        indistinguishable=_share_of_mutants(own, lambda facts: facts.indistinguishable),
        informative=_share_of_mutants(own, lambda facts: facts.informative),
        redundancy=Redundancy.of({member.mutant.id: member.outcomes for member in members}),
        joint=len(homes),
        alone=sum(home == {key} for home in homes),
    )


def _share_of_mutants(own: Iterable[Properties], answer: Callable[[Properties], bool | None]) -> Share:
    return Share.of_mutants(answer(facts) for facts in own)


def _share_of_outcomes(ends: Sequence[Sequence[End | None]], those: Collection[End]) -> Share:
    """The share of (mutant, round) pairs that end so.

    The interval is that of scores; with one round, in which nothing tells how rounds differ, it is Wilson's
    over mutants, and speaks about this round alone.
    """
    table = [[float(end in those) if end is not None else None for end in row] for row in ends]
    cells = [cell for row in table for cell in row if cell is not None]
    count = round(sum(cells))
    in_one_round = max((len(row) for row in table), default=0) == 1 and len(cells) > 1
    return Share(count, len(cells), interval=wilson(count, len(cells)) if in_one_round else crossed(table))
