"""Trunks, seen from the controller: one per round or several, and what their branches report.

A branch's report counts only once the trunk itself has passed the same test as in the baseline: the trunk is
the second run of the original. What could not be branched, or got lost with a trunk, is left to another
engine.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from mutabot.border.events import (
    BranchDied,
    BranchEnd,
    Event,
    SiteSeen,
    Unbranched,
    Undiverged,
    Untrusted,
)
from mutabot.border.job import Branching
from mutabot.border.test_end import TestEnd
from mutabot.campaign.baseline.observed import observation, place_of
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.comparing.moments import moments_in
from mutabot.campaign.comparing.observation import Observation
from mutabot.campaign.workers.task import Result, Task, at, death, how_ended
from mutabot.model import Instrumentation, Mutant, Outcome, Verdict
from mutabot.model.place import Place

from .engine import Remainder, Trial
from .fresh import wall_limit, without_tests
from .judge import Death, Run, judged, not_judged, refuse_others

#: seconds without any word from a trunk, beyond what its tests and branches may take
_PATIENCE = 60.0
#: mutants under which a part costs more than it spreads, and parts for each place: they are not equally long
_LEAST, _PARTS = 10, 16
#: fewer do where the branches of a part would take less than so many times its own tests; but not fewer than
_WORTH, _FEWEST = 4, 2
#: seconds that a branch takes at least
_FORK = 0.01


class Trunks:
    """The trunks of all rounds, cut into parts where places share nothing.

    Args:
        campaign: the campaign.
        left: is filled with what is left to another engine.
        engine: the name of the engine that asks.

    Attributes:
        suspects: (round, test) that ended otherwise in a trunk than in the baseline.
        orders: per round, the tests of the trunk in its order.
        hindered: why a limit of wall clock that ended them says little, by mutant and round.
    """

    def __init__(self, campaign: Campaign, left: Remainder, engine: str) -> None:
        self._campaign, self._left, self._engine = campaign, left, engine
        self.suspects: list[tuple[int, str]] = []
        self.orders: dict[int, tuple[str, ...]] = {}
        self.hindered: dict[tuple[str, int], str] = {}
        self._trunks: dict[int, _Trunk] = {}

    def run(
        self, trials: Iterable[Trial], *, only: Mapping[str, tuple[str, ...]] | None = None
    ) -> Iterator[Outcome]:
        """Outcomes of mutants in rounds, as they come.

        ``only`` names the tests that judge certain mutants, by id; all others are judged by every test that
        reaches them.
        """
        baseline = self._campaign.baseline
        for mutant, round in trials:
            tests = (only or {}).get(mutant.id) or baseline.judges(round, mutant)
            if tests:
                self._add(mutant, round, tests)
            else:
                yield without_tests(baseline, mutant, round)
        self.orders.update((round, trunk.order) for round, trunk in self._trunks.items())
        parts = cut(list(self._trunks.values()), self._campaign.executor.spread)
        by_key = dict(enumerate(parts))
        # the text of all rounds alike, so that one fork server can serve them
        text = baseline.faults.instrumentation(
            {one.id: one for trunk in self._trunks.values() for one in trunk.mutants}.values()
        )
        tasks = (trunk.task(key, text) for key, trunk in by_key.items())
        for event in self._campaign.executor.events(tasks):
            if isinstance(event, Result):
                yield from by_key[event.task.key].finish(event)
            else:
                task, line = event
                yield from by_key[task.key].take(line)

    def _add(self, mutant: Mutant, round: int, tests: tuple[str, ...]) -> None:
        baseline = self._campaign.baseline
        why = baseline.why_apart(mutant)
        if why is not None:
            self._left.set_apart(mutant, round, why)
            return
        if round not in self._trunks:
            self._trunks[round] = _Trunk(
                self._campaign, round, self._left, self.suspects, self._engine, self.hindered
            )
        forbidding = baseline.why_not_branch(round, tests)
        if forbidding is not None:
            self._left.leave(mutant, round, *forbidding)
            self._trunks[round].run_too(tests)
        else:
            self._trunks[round].add(mutant, tests)


def cut(trunks: list[_Trunk], places: int) -> list[_Trunk]:
    """Trunks in parts for so many places that share nothing, the longest first; as they are for one."""
    if places < 2 or not trunks:
        return trunks
    whole = sum(trunk.seconds for trunk in trunks) or 1.0
    parts = (trunk.parts(places * trunk.seconds / whole) for trunk in trunks)
    return sorted((part for some in parts for part in some), key=lambda part: -part.seconds)


@dataclass(slots=True)
class _Branches:
    """What is known of one mutant so far.

    Attributes:
        mutant: the mutant.
        tests: the tests that judge it, in order.
        ends, observations: its tests that have ended.
        deaths: set for the tests in which its branch died.
        shared: simulated seconds its branches inherited.
    """

    mutant: Mutant
    tests: tuple[str, ...]
    ends: dict[str, TestEnd] = field(default_factory=dict)
    observations: dict[str, Observation] = field(default_factory=dict)
    deaths: dict[str, Death] = field(default_factory=dict)
    shared: float | None = None

    def take(self, line: BranchEnd) -> None:
        self.ends[line.end.test] = line.end
        if line.shared is not None:
            self.shared = (self.shared or 0.0) + line.shared


class _Trunk:
    """The trunk of one round and its branches."""

    def __init__(
        self,
        campaign: Campaign,
        round: int,
        left: Remainder,
        suspects: list[tuple[int, str]],
        engine: str,
        hindered: dict[tuple[str, int], str],
    ) -> None:
        self._campaign, self._round, self._left, self._suspects = campaign, round, left, suspects
        self._engine, self._hindered = engine, hindered
        self._baseline, self._sources = campaign.baseline, campaign.sources
        self._open: dict[str, _Branches] = {}
        self._needed: set[str] = set()
        self._passed: set[str] = set()
        self._failed: set[str] = set()
        self._waiting: dict[str, set[str]] = {}
        self._undiverged: dict[str, Mapping[str, int]] = {}
        self._trunk_places: dict[int, Place] = {}
        self._doubted: list[Mutant] = []

    def add(self, mutant: Mutant, tests: tuple[str, ...]) -> None:
        """A mutant to branch in these tests."""
        self._open[mutant.id] = _Branches(mutant, tests)
        self._needed.update(tests)

    def run_too(self, tests: tuple[str, ...]) -> None:
        """Tests to run although nothing is branched in them: the trunk is their second run."""
        self._needed.update(tests)

    @property
    def mutants(self) -> tuple[Mutant, ...]:
        """The mutants whose outcomes are not known yet."""
        return tuple(branches.mutant for branches in self._open.values())

    @property
    def order(self) -> tuple[str, ...]:
        """The tests it runs, in their order."""
        return self._baseline.in_order(self._round, self._needed)

    @property
    def seconds(self) -> float:
        """What its own tests and its branches take at most, by those of the baseline."""
        return self._own + sum(map(self._branches_seconds, self._open.values()))

    @property
    def _own(self) -> float:
        """What its own tests take."""
        return sum(self._wall(test) for test in self._needed)

    def parts(self, places: float) -> list[_Trunk]:
        """Trunks with a part of the mutants each, for so many places; equal tests stay together."""
        seconds = sum(map(self._branches_seconds, self._open.values()))
        worth = max(_FEWEST * places, seconds / (_WORTH * (self._own or 1.0)))
        count = min(math.ceil(min(_PARTS * places, worth)), len(self._open) // _LEAST)
        if count < 2:
            return [self]
        branches = sorted(self._open.values(), key=lambda one: (one.tests, one.mutant.id))
        share = seconds / count
        found, used, bare = list[_Trunk](), 0.0, set(self._needed)
        for one in branches:
            if not found or (used >= share * len(found) and len(found) < count):
                found.append(self._empty())
            found[-1].add(one.mutant, one.tests)
            used += self._branches_seconds(one)
            bare.difference_update(one.tests)
        found[0].run_too(tuple(bare))
        return found

    def _empty(self) -> _Trunk:
        return _Trunk(self._campaign, self._round, self._left, self._suspects, self._engine, self._hindered)

    def _wall(self, test: str) -> float:
        return self._baseline.ends[self._round, test].wall

    def _branches_seconds(self, branches: _Branches) -> float:
        return sum(self._wall(test) for test in branches.tests) + _FORK

    def task(self, key: int, text: Instrumentation | None) -> Task:
        """The task that runs the trunk."""
        request, baseline, round = self._campaign.request, self._baseline, self._round
        in_order = self.order
        walls = {test: wall_limit(self._campaign, round, test) for test in in_order}
        longest = max(walls.values(), default=0.0)
        mutants = self.mutants
        choices = {mutant.id: baseline.faults.choices(mutant) for mutant in mutants}
        branching = Branching(
            mutants=mutants,
            tests={mutant: branches.tests for mutant, branches in self._open.items()},
            walls=walls,
            wall=longest,
            choices={mutant: found for mutant, found in choices.items() if found},
            every_test=request.every_test,
        )
        factor = request.configuration.timeout_factor
        budgets = {test: baseline.budget(round, test, factor) for test in in_order}
        job = request.job(
            round,
            tests=in_order,
            record=True,
            budgets=budgets,
            moments=moments_in(baseline.strides, round),
            refused=baseline.refused_in(round, in_order),
            branching=branching,
            instrumentation=text,
        )
        patience = 2.0 * longest + _PATIENCE
        return Task(key, job, {}, patience, patience, is_trunk=True, may_share=True)

    def take(self, line: Event) -> Iterator[Outcome]:
        """Sort in an event; yields the outcomes that it settles.

        What goes wrong with it is an error of its mutant, or leaves its test to replay.
        """
        try:
            yield from self._take(line)
        except Exception as error:
            yield from self._give_up(line, error)

    def _give_up(self, line: Event, error: Exception) -> Iterator[Outcome]:
        refuse_others(error)
        branches = self._open.get(line.mutant) if isinstance(line, BranchEnd | BranchDied) else None
        if branches is not None:
            del self._open[branches.mutant.id]
            yield not_judged(branches.mutant, self._round, error, self._engine)
            return
        self._left.notes.append(f"a report of the trunk cannot be used: {type(error).__name__}: {error}")
        if isinstance(line, TestEnd):
            self._failed.add(line.test)

    def _take(self, line: Event) -> Iterator[Outcome]:
        match line:
            case BranchEnd() if line.mutant in self._open:
                yield from self._branch_ended(line)
            case BranchDied() if line.mutant in self._open:
                yield from self._branch_died(line)
            case Unbranched():
                self._left.reasons.setdefault(line.test, line.reason)
            case Undiverged():
                self._undiverged[line.test] = line.hits
            case SiteSeen():
                self._trunk_places[line.index] = place_of(line, self._sources)
            case TestEnd():
                yield from self._test_ended(line)
            case Untrusted():
                self._doubt(line)

    def _doubt(self, line: Untrusted) -> None:
        """What the trunk itself tells cannot be relied on; branches have files of their own.

        All that is open is left to an engine in which each mutant has a process of its own. Outcomes that are
        settled are not concerned.
        """
        why = f"round {self._round + 1}: {line.reason}; mutants that may have to do with it run in processes"
        self._left.notes.append(f"{why} of their own")
        self._doubted += [branches.mutant for branches in self._open.values()]
        self._open.clear()

    def finish(self, result: Result) -> Iterator[Outcome]:
        """The trunk is gone: settle what can be settled, and leave the rest to replay."""
        if result.end is None:
            self._left.notes.append(f"the trunk of round {self._round + 1} died: {death(result)}{at(result)}")
        for mutant in list(self._open):
            yield from self._settle(mutant)
        left = [*self._doubted, *(branches.mutant for branches in self._open.values())]
        self._left.trials.extend((mutant, self._round) for mutant in left)

    def _branch_ended(self, line: BranchEnd) -> Iterator[Outcome]:
        branches = self._open[line.mutant]
        branches.take(line)
        if line.end.outcome != "failed":
            places = {seen.index: place_of(seen, self._sources) for seen in line.sites}
            branches.observations[line.end.test] = observation(line.end, places)
        yield from self._settle(line.mutant)

    def _branch_died(self, line: BranchDied) -> Iterator[Outcome]:
        branches = self._open[line.mutant]
        code = line.exit_code
        branches.deaths[line.test] = Death(
            text=f"{line.overdue or how_ended(code)} during {line.test}",
            test=line.test,
            signal=-code if code < 0 and line.overdue is None else None,
            overdue=line.overdue is not None,
            acted=line.acted,
            in_mutated_call=line.in_mutated_call,
            where=line.where,
            hindered=line.hindered,
            is_starved=line.is_starved,
        )
        yield from self._settle(line.mutant)

    def _test_ended(self, end: TestEnd) -> Iterator[Outcome]:
        """The trunk has run a test: the second opinion on the original."""
        undiverged = self._undiverged.pop(end.test, {})
        if end.lasting == self._baseline.ends[self._round, end.test].lasting:
            self._passed.add(end.test)
            found = observation(end, self._trunk_places)
            self._baseline.compare_runs(self._round, end, found, self._campaign.request.vocabulary)
            if self._campaign.evidence is not None:
                self._campaign.evidence.add_again(self._round, end)
            self._take_undiverged(end, found, undiverged)
        else:
            self._failed.add(end.test)
            self._suspects.append((self._round, end.test))
        for mutant in self._waiting.pop(end.test, set()) | undiverged.keys():
            if mutant in self._open:
                yield from self._settle(mutant)

    def _take_undiverged(self, end: TestEnd, found: Observation, hits: Mapping[str, int]) -> None:
        """The trunk has run its test for these mutants too, up to the end."""
        for mutant in hits.keys() & self._open.keys():
            branches = self._open[mutant]
            own = replace(end, hits=hits[mutant], acted=0, wall=0.0, cpu=0.0, trace=(), recording=None)
            branches.take(BranchEnd(mutant, own, (), end.simulated))
            branches.observations[end.test] = found

    def _settle(self, mutant: str) -> Iterator[Outcome]:
        """Yield the mutant's outcome if all that it depends on is known."""
        branches = self._open[mutant]
        run = Run(branches.mutant, self._round, branches.tests, engine=self._engine, shared=branches.shared)
        goes_on = self._campaign.request.every_test
        for test in branches.tests:
            if test in self._failed:
                return  # replay will find out what is the matter with this test
            death = branches.deaths.get(test)
            if test not in branches.ends and death is None:
                return
            if test not in self._passed:
                self._waiting.setdefault(test, set()).add(mutant)
                return
            if death is not None:
                run.death = run.death or death
            else:
                run.ends.append(branches.ends[test])
            if not goes_on and (death is not None or branches.ends[test].is_decided):
                break
        run.observations = branches.observations
        run.wall = sum(end.wall for end in run.ends)
        outcome = judged(self._campaign, run)
        survived = outcome.verdict is Verdict.SURVIVED
        if survived and self._baseline.must_widen(run.mutant, run.round, run.ends):
            return  # to replay
        if run.hindered is not None:
            self._hindered[mutant, self._round] = run.hindered
        del self._open[mutant]
        yield outcome
