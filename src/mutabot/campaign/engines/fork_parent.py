"""Trunks, seen from the controller: one per round or several, and what their branches report.

The trunk is the second run of the original. What a branch tells counts only if all tests up to the one in
which it was forked ended in the trunk as in the baseline: mutants that were forked after another end are left
to another engine, as are those that could not be branched, or got lost with a trunk.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from mutabot.campaign.baseline.baseline import observation, place_of
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.comparison import Observation, moments_in
from mutabot.campaign.engines.engine import Remainder, Trial
from mutabot.campaign.engines.fresh import not_run, startup_limit, wall_limit, without_tests
from mutabot.campaign.verdict import Death, Run, judged, not_judged, refuse_others
from mutabot.execution.task import Result, Task, at, death, how_ended
from mutabot.families import CONTROL
from mutabot.model import Instrumentation, Mutant, Outcome
from mutabot.model.events import (
    BranchDied,
    BranchEnd,
    BranchFinished,
    Event,
    SiteSeen,
    TestEnd,
    Unbranched,
    Undiverged,
    Untrusted,
)
from mutabot.model.job import Branching
from mutabot.model.mutant import Place

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
        hindered: why a limit of wall clock that ended them says little, by mutant and round.
    """

    def __init__(self, campaign: Campaign, left: Remainder, engine: str) -> None:
        self._campaign, self._left, self._engine = campaign, left, engine
        self.suspects: list[tuple[int, str]] = []
        self.hindered: dict[tuple[str, int], str] = {}
        self._trunks: dict[int, _Trunk] = {}

    def run(self, trials: Iterable[Trial]) -> Iterator[Outcome]:
        """Outcomes of mutants in rounds, as they come."""
        baseline = self._campaign.baseline
        for mutant, round in trials:
            # a control that may not have a test of its own is no mutant of any test
            if mutant.family == CONTROL or baseline.tests_reaching(round, mutant):
                self._add(mutant, round)
            else:
                yield without_tests(baseline, mutant, round)
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

    def _add(self, mutant: Mutant, round: int) -> None:
        baseline = self._campaign.baseline
        if round not in self._trunks:  # also if nothing is branched in it: it is the second run
            self._trunks[round] = _Trunk(
                self._campaign, round, self._left, self.suspects, self._engine, self.hindered
            )
        why = baseline.why_apart(mutant)
        if why is not None:
            self._left.set_apart(mutant, round, why)
        else:
            self._trunks[round].add(mutant)


def cut(trunks: list[_Trunk], places: int) -> list[_Trunk]:
    """Trunks in parts for so many places that share nothing, the longest first; as they are for one."""
    if places < 2 or not trunks:
        return trunks
    whole = sum(trunk.seconds for trunk in trunks) or 1.0
    parts = (trunk.parts(places * trunk.seconds / whole) for trunk in trunks)
    return sorted((part for some in parts for part in some), key=lambda part: -part.seconds)


@dataclass(slots=True)
class _Branch:
    """What is known of one mutant so far.

    Attributes:
        mutant: the mutant.
        ends, observations: its tests that have ended.
        death: set if its branch died.
        exit_code: how it ended, if it went to the end of the session.
        forked: number of the test in which it was forked, as far as it has told; -1: before any.
        shared: simulated seconds it inherited in that test.
    """

    mutant: Mutant
    ends: dict[str, TestEnd] = field(default_factory=dict)
    observations: dict[str, Observation] = field(default_factory=dict)
    death: Death | None = None
    exit_code: int | None = None
    forked: int | None = None
    shared: float | None = None

    def take(self, line: BranchEnd, number: int) -> None:
        if self.forked is None:
            self.forked = -1 if line.is_early else number
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
        self._open: dict[str, _Branch] = {}
        self._tests = self._baseline.suite(round)
        self._numbers = {test: number for number, test in enumerate(self._tests)}
        self._own_ends: list[TestEnd] = []
        self._is_off = False
        self._waiting: dict[int, set[str]] = {}
        self._undiverged: dict[str, Mapping[str, int]] = {}
        self._trunk_places: dict[int, Place] = {}
        self._doubted: list[Mutant] = []
        self._left_out: Mapping[str, frozenset[str]] = {}

    def add(self, mutant: Mutant) -> None:
        """A mutant to branch."""
        self._open[mutant.id] = _Branch(mutant)

    @property
    def mutants(self) -> tuple[Mutant, ...]:
        """The mutants whose outcomes are not known yet."""
        return tuple(branch.mutant for branch in self._open.values())

    @property
    def seconds(self) -> float:
        """What its own tests and its branches take at most, by those of the baseline."""
        return self._own * (1 + len(self._open)) + _FORK * len(self._open)

    @property
    def _own(self) -> float:
        """What its own tests take."""
        return sum(self._baseline.ends[self._round, test].wall for test in self._tests)

    def parts(self, places: float) -> list[_Trunk]:
        """Trunks with a part of the mutants each, for so many places; what equal tests reach is together."""
        worth = max(_FEWEST * places, len(self._open) / _WORTH)
        count = min(math.ceil(min(_PARTS * places, worth)), len(self._open) // _LEAST)
        if count < 2:
            return [self]
        reaching = self._baseline.tests_reaching
        mutants = sorted(self.mutants, key=lambda one: (reaching(self._round, one), one.id))
        found = [self._empty() for _ in range(count)]
        for number, mutant in enumerate(mutants):
            found[number * count // len(mutants)].add(mutant)
        return found

    def _empty(self) -> _Trunk:
        return _Trunk(self._campaign, self._round, self._left, self._suspects, self._engine, self._hindered)

    def task(self, key: int, text: Instrumentation | None) -> Task:
        """The task that runs the trunk."""
        request, baseline, round = self._campaign.request, self._baseline, self._round
        in_order = self._tests
        walls = {test: wall_limit(self._campaign, round, test) for test in in_order}
        longest = max(walls.values(), default=0.0)
        mutants = self.mutants
        choices = {mutant.id: baseline.faults.choices(mutant) for mutant in mutants}
        branching = Branching(
            mutants=mutants,
            walls=walls,
            wall=longest,
            startup=startup_limit(self._campaign),
            choices={mutant: found for mutant, found in choices.items() if found},
            every_test=request.every_test,
            serial=baseline.is_exclusive(round),
            at_start=self._at_start(),
        )
        factor = request.configuration.timeout_factor
        budgets = {test: baseline.budget(round, test, factor) for test in in_order}
        job = request.job(
            round,
            tests=in_order,
            reaching=self._campaign.reaching(mutants, round),
            record=True,
            budgets=budgets,
            moments=moments_in(baseline.strides, round),
            refused=baseline.refused_in(round, in_order),
            known=baseline.known,
            branching=branching,
            instrumentation=text,
        )
        self._left_out = {mutant.id: job.left_out(mutant.id) for mutant in mutants}
        # it waits for branches that go to the end
        patience = 2.0 * sum(walls.values()) + branching.startup + _PATIENCE
        may_share = not any(map(baseline.is_early, mutants))  # else it forks while it imports the program
        return Task(
            key, job, {}, patience, patience, is_trunk=True, may_share=may_share, alone=branching.serial
        )

    def _at_start(self) -> dict[str, tuple[str, ...]]:
        """Mutants by the tests that reach them and have processes below them."""
        found: dict[str, list[str]] = {}
        for mutant in self.mutants:
            for test in self._baseline.tests_reaching(self._round, mutant):
                if self._baseline.ends[self._round, test].processes:
                    found.setdefault(test, []).append(mutant.id)
        return {test: tuple(mutants) for test, mutants in found.items()}

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
        branch = self._open.get(line.mutant) if isinstance(line, BranchEnd | BranchDied) else None
        if branch is not None:
            del self._open[branch.mutant.id]
            yield not_judged(branch.mutant, self._round, error, self._engine)
            return
        self._left.notes.append(f"a report of the trunk cannot be used: {type(error).__name__}: {error}")
        self._is_off = self._is_off or isinstance(line, TestEnd)

    def _take(self, line: Event) -> Iterator[Outcome]:
        match line:
            case BranchEnd() if line.mutant in self._open:
                yield from self._branch_ended(line)
            case BranchDied() if line.mutant in self._open:
                yield from self._branch_died(line)
            case BranchFinished():
                for mutant in self._open.keys() & set(line.mutants):
                    self._open[mutant].exit_code = line.exit_code
                    if line.errors:
                        self._open[mutant].death = Death("; ".join(line.errors))
                    yield from self._settle(mutant)
            case Unbranched():
                self._left.reasons.setdefault(line.test, line.reason)
                for mutant in self._open.keys() & set(line.mutants):
                    self._doubted.append(self._open.pop(mutant).mutant)
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
        self._doubted += self.mutants
        self._open.clear()

    def finish(self, result: Result) -> Iterator[Outcome]:
        """The trunk is gone: settle what can be settled, and leave the rest to replay."""
        if result.end is None:
            self._left.notes.append(f"the trunk of round {self._round + 1} died: {death(result)}{at(result)}")
        for mutant in list(self._open):
            yield from self._settle_undiverged(mutant)
        left = [*self._doubted, *self.mutants]
        self._left.trials.extend((mutant, self._round) for mutant in left)

    def _branch_ended(self, line: BranchEnd) -> Iterator[Outcome]:
        branch = self._open[line.mutant]
        branch.take(line, self._numbers[line.end.test])
        if line.end.outcome != "failed":
            places = {seen.index: place_of(seen, self._sources) for seen in line.sites}
            branch.observations[line.end.test] = observation(line.end, places)
        yield from self._settle(line.mutant)

    def _branch_died(self, line: BranchDied) -> Iterator[Outcome]:
        code = line.exit_code
        during = f" during {line.test}" if line.test else ""
        self._open[line.mutant].death = Death(
            text=f"{line.overdue or how_ended(code)}{during}",
            test=line.test or None,
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
        if end.lasting != self._baseline.ends[self._round, end.test].lasting:
            self._is_off = True
            self._suspects.append((self._round, end.test))
        if self._is_off:
            return
        found = observation(end, self._trunk_places)
        self._baseline.compare_runs(self._round, end, found, self._campaign.request.vocabulary)
        if self._campaign.evidence is not None:
            self._campaign.evidence.add_again(self._round, end)
        own = replace(end, hits=0, acted=0, wall=0.0, cpu=0.0, trace=(), recording=None)
        self._own_ends.append(own)
        for mutant in undiverged.keys() & self._open.keys():
            branch = self._open[mutant]
            branch.ends.setdefault(end.test, replace(own, hits=undiverged[mutant]))
            branch.observations.setdefault(end.test, found)
        for mutant in self._waiting.pop(len(self._own_ends) - 1, set()) & self._open.keys():
            yield from self._settle(mutant)

    def _settle(self, mutant: str) -> Iterator[Outcome]:
        """Yield the mutant's outcome if all that it depends on is known."""
        branch = self._open[mutant]
        is_decided = any(end.is_decided for end in branch.ends.values())
        is_over = branch.death is not None or branch.exit_code is not None
        if not is_over and (not is_decided or self._campaign.request.every_test):
            return
        died_in = branch.death.test if branch.death is not None else None
        forked = branch.forked if branch.forked is not None else self._numbers.get(died_in or "", -1)
        # a survivor is compared with the original in all tests: those that the trunk runs after the fork, too
        last = forked if is_decided or branch.death is not None else len(self._tests) - 1
        if last >= len(self._own_ends):
            self._waiting.setdefault(last, set()).add(mutant)
            return
        before = {end.test: end for end in self._own_ends[: max(0, forked)]}
        yield from self._judged(branch, {**before, **branch.ends})

    def _settle_undiverged(self, mutant: str) -> Iterator[Outcome]:
        """The trunk has run all tests, and nothing differed: it was the mutant's run as well."""
        branch = self._open[mutant]
        is_same = bool(branch.ends) and branch.forked is None and branch.death is None
        if is_same and len(self._own_ends) == len(self._tests) and not self._is_off:
            branch.exit_code = self._baseline.exits[self._round]
            simulated = [one.simulated for one in self._own_ends if one.simulated is not None]
            branch.shared = sum(simulated) if simulated else None
            yield from self._judged(branch, {**{one.test: one for one in self._own_ends}, **branch.ends})

    def _judged(self, branch: _Branch, ends: Mapping[str, TestEnd]) -> Iterator[Outcome]:
        run = Run(branch.mutant, self._round, self._tests, engine=self._engine, shared=branch.shared)
        run.ends = [ends[test] for test in self._tests if test in ends]
        run.left_out = self._left_out[branch.mutant.id]
        run.death, run.exit_code = branch.death, branch.exit_code
        if run.exit_code is not None:
            text = not_run({*self._tests} - run.left_out, run.ends, run.exit_code)
            run.death = Death(text) if text is not None else run.death
        run.observations = branch.observations
        run.wall = sum(end.wall for end in run.ends)
        outcome = judged(self._campaign, run)
        if run.hindered is not None:
            self._hindered[branch.mutant.id, self._round] = run.hindered
        del self._open[branch.mutant.id]
        yield outcome
