"""Fork parents, seen from the controller: processes that run the suite as the original and fork mutants.

There is one per round, or several where places share nothing. A fork parent is the second run of the
original. What a fork tells counts only if all tests up to the one in which it was forked ended in its parent
as in the baseline. Mutants that were forked later are left to replay, as are those that could not be forked,
or got lost with their parent.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from mutabot.campaign.baseline.baseline import observation, place_of
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.request import FORK
from mutabot.campaign.verdict import Death, Run, judged, not_judged, refuse_others
from mutabot.execution.task import Result, Task, death, how_ended
from mutabot.families import CONTROL
from mutabot.model import Instrumentation, Mutant, Outcome
from mutabot.model.events import (
    Event,
    ForkDied,
    ForkSessionEnd,
    ForkTestEnd,
    SiteSeen,
    TestEnd,
    Undiverged,
    Unforked,
    Untrusted,
)
from mutabot.model.job import Forking
from mutabot.model.mutant import Place

from .isolated_run import MutantRun, job_of, not_run, startup_limit, wall_limits, without_tests

#: seconds without any word from a fork parent, beyond what its tests and forks may take
_PATIENCE = 60.0
#: mutants under which a part costs more than it spreads, and parts for each place: they are not equally long
_LEAST, _PARTS = 10, 16
#: fewer do where the forks of a part would take less than so many times its own tests; but not fewer than
_WORTH, _FEWEST = 4, 2
#: seconds that a fork takes at least
_FORK = 0.01


@dataclass(slots=True)
class Unhandled:
    """What ``fork`` leaves to replay.

    Attributes:
        runs: mutants and rounds.
        apart: ids of mutants that need a process of their own, whatever their tests.
        reasons: test to why mutants cannot be forked in it.
        notes: what else went wrong, in words.
    """

    runs: list[MutantRun] = field(default_factory=list)
    apart: set[str] = field(default_factory=set)
    reasons: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def why(self, mutant: Mutant) -> str:
        """Why a mutant is left, in words."""
        if mutant.id in self.apart:
            return "it is in place from the start of each test"
        return "; ".join(dict.fromkeys([*self.reasons.values(), *self.notes]))


class ForkParents:
    """The fork parents of all rounds, cut into parts where places share nothing.

    Args:
        campaign: the campaign.
        left: is filled with what is left to replay.

    Attributes:
        suspects: (round, test) that ended otherwise in a fork parent than in the baseline.
    """

    def __init__(self, campaign: Campaign, left: Unhandled) -> None:
        self.campaign, self.left = campaign, left
        self.suspects: list[tuple[int, str]] = []

    def run(self, runs: Iterable[MutantRun]) -> Iterator[Outcome]:
        """Run mutants in rounds. Yields outcomes as they come."""
        baseline = self.campaign.baseline
        parents: dict[int, _ForkParent] = {}
        for mutant, round in runs:
            # a control that may not have a test of its own is no mutant of any test
            if mutant.family != CONTROL and not baseline.tests_reaching(round, mutant):
                yield without_tests(baseline, mutant, round)
                continue
            if round not in parents:  # also if nothing is forked in it: it is the second run
                parents[round] = _ForkParent(self, round)
            if baseline.is_apart(mutant):
                self.left.runs.append((mutant, round))
                self.left.apart.add(mutant.id)
            else:
                parents[round].add(mutant)
        # the text of all rounds alike, so that one fork server can serve them
        text = baseline.faults.instrumentation(
            {one.id: one for parent in parents.values() for one in parent.mutants}.values()
        )
        by_key = dict(enumerate(cut(list(parents.values()), self.campaign.executor.spread)))
        tasks = (parent.task(key, text) for key, parent in by_key.items())
        for event in self.campaign.executor.events(tasks):
            if isinstance(event, Result):
                yield from by_key[event.task.key].finish(event)
            else:
                yield from by_key[event[0].key].take(event[1])


def cut(parents: list[_ForkParent], places: int) -> list[_ForkParent]:
    """Cut fork parents into parts for so many places that share nothing. The longest come first."""
    if places < 2 or not parents:
        return parents
    whole = sum(one.seconds for one in parents) or 1.0
    parts = [part for one in parents for part in one.parts(places * one.seconds / whole)]
    return sorted(parts, key=lambda part: -part.seconds)


@dataclass(slots=True)
class _ForkedRun:
    """What is known of one mutant so far.

    Attributes:
        run: what the judge gets.
        ends: its tests that have ended.
        forked: number of the test in which it was forked, as far as it has told; -1: before any.
    """

    run: Run
    ends: dict[str, TestEnd] = field(default_factory=dict)
    forked: int | None = None


class _ForkParent:
    """The fork parent of one round and its forks."""

    def __init__(self, parents: ForkParents, round: int) -> None:
        self._parents, self._round = parents, round
        self._campaign, self._left = parents.campaign, parents.left
        self._baseline, self._sources = self._campaign.baseline, self._campaign.sources
        self._open: dict[str, _ForkedRun] = {}
        self._tests = self._baseline.suite(round)
        self._numbers = {test: number for number, test in enumerate(self._tests)}
        self._own_ends: list[TestEnd] = []
        self._is_off = False
        self._waiting: dict[int, set[str]] = {}
        self._undiverged: dict[str, Mapping[str, int]] = {}
        self._places: dict[int, Place] = {}

    def add(self, mutant: Mutant) -> None:
        """Add a mutant to fork."""
        self._open[mutant.id] = _ForkedRun(Run(mutant, self._round, self._tests, engine=FORK))

    @property
    def mutants(self) -> tuple[Mutant, ...]:
        """The mutants whose outcomes are not known yet."""
        return tuple(fork.run.mutant for fork in self._open.values())

    @property
    def seconds(self) -> float:
        """What its own tests and its forks take at most, by those of the baseline."""
        own = sum(self._baseline.ends[self._round, test].wall for test in self._tests)
        return own * (1 + len(self._open)) + _FORK * len(self._open)

    def parts(self, places: float) -> list[_ForkParent]:
        """Fork parents with a part of the mutants each. What equal tests reach is together."""
        worth = max(_FEWEST * places, len(self._open) / _WORTH)
        count = min(math.ceil(min(_PARTS * places, worth)), len(self._open) // _LEAST)
        if count < 2:
            return [self]
        reaching = self._baseline.tests_reaching
        mutants = sorted(self.mutants, key=lambda one: (reaching(self._round, one), one.id))
        found = [_ForkParent(self._parents, self._round) for _ in range(count)]
        for number, mutant in enumerate(mutants):
            found[number * count // len(mutants)].add(mutant)
        return found

    def task(self, key: int, text: Instrumentation | None) -> Task:
        """The task that runs the fork parent."""
        campaign, baseline, mutants = self._campaign, self._baseline, self.mutants
        walls = wall_limits(campaign, self._round, self._tests)
        choices = {mutant.id: baseline.faults.choices(mutant) for mutant in mutants}
        at_start: dict[str, tuple[str, ...]] = {}  # where tests have processes below them
        for mutant in mutants:
            for test in baseline.tests_reaching(self._round, mutant):
                if baseline.ends[self._round, test].processes:
                    at_start[test] = (*at_start.get(test, ()), mutant.id)
        forking = Forking(
            mutants=mutants,
            walls=walls,
            wall=max(walls.values(), default=0.0),
            startup=startup_limit(campaign),
            choices={mutant: found for mutant, found in choices.items() if found},
            every_test=campaign.request.every_test,
            serial=baseline.is_exclusive(self._round),
            at_start=at_start,
        )
        job = job_of(campaign, self._round, self._tests, mutants, forking=forking, instrumentation=text)
        for fork in self._open.values():
            fork.run.left_out = job.left_out(fork.run.mutant.id)
        # it waits for forks that go to the end
        patience = 2.0 * sum(walls.values()) + forking.startup + _PATIENCE
        may_share = not any(map(baseline.is_early, mutants))  # else it forks while it imports the program
        return Task(
            key, job, {}, patience, patience, is_fork_parent=True, may_share=may_share, alone=forking.serial
        )

    def take(self, event: Event) -> Iterator[Outcome]:
        """Sort in an event. Yields the outcomes that it settles.

        What goes wrong with it is an error of its mutant, or leaves its test to replay.
        """
        try:
            yield from self._take(event)
        except Exception as error:
            refuse_others(error)
            fork = self._open.get(event.mutant) if isinstance(event, ForkTestEnd | ForkDied) else None
            if fork is not None:
                del self._open[fork.run.mutant.id]
                yield not_judged(fork.run.mutant, self._round, error, FORK)
                return
            text = f"a report of the fork parent cannot be used: {type(error).__name__}: {error}"
            self._left.notes.append(text)
            self._is_off = self._is_off or isinstance(event, TestEnd)

    def _take(self, event: Event) -> Iterator[Outcome]:
        match event:
            case ForkTestEnd() if event.mutant in self._open:
                yield from self._fork_ended(event)
            case ForkDied() if event.mutant in self._open:
                self._open[event.mutant].run.death = _death_of(event)
                yield from self._settle(event.mutant)
            case ForkSessionEnd():
                for mutant in self._open.keys() & set(event.mutants):
                    run = self._open[mutant].run
                    run.exit_code = event.exit_code
                    run.death = Death("; ".join(event.errors)) if event.errors else run.death
                    yield from self._settle(mutant)
            case Unforked():
                self._left.reasons.setdefault(event.test, event.reason)
                self._leave(self._open.keys() & set(event.mutants))
            case Undiverged():
                self._undiverged[event.test] = event.hits
            case SiteSeen():
                self._places[event.index] = place_of(event, self._sources)
            case TestEnd():
                yield from self._test_ended(event)
            case Untrusted():  # forks have files of their own: outcomes that are settled are not concerned
                self._left.notes.append(
                    f"round {self._round + 1}: {event.reason}; mutants that may have to do with it run in "
                    "processes of their own"
                )
                self._leave(list(self._open))

    def _leave(self, mutants: Iterable[str]) -> None:
        self._left.runs += [(self._open.pop(mutant).run.mutant, self._round) for mutant in mutants]

    def finish(self, result: Result) -> Iterator[Outcome]:
        """The process is gone: settle what can be settled, and leave the rest to replay."""
        if result.end is None:
            self._left.notes.append(f"the fork parent of round {self._round + 1} died: {death(result)}")
        is_whole = len(self._own_ends) == len(self._tests) and not self._is_off
        simulated = [end.simulated for end in self._own_ends if end.simulated is not None]
        for fork in list(self._open.values()):
            # nothing differed: it was the mutant's run as well
            if is_whole and fork.ends and fork.forked is None and fork.run.death is None:
                fork.run.exit_code = self._baseline.exits[self._round]
                fork.run.shared = sum(simulated) if simulated else None
                yield self._judged(fork, len(self._tests))
        self._leave(list(self._open))

    def _fork_ended(self, event: ForkTestEnd) -> Iterator[Outcome]:
        fork, test = self._open[event.mutant], event.end.test
        if fork.forked is None:
            fork.forked = -1 if event.is_early else self._numbers[test]
        fork.ends[test] = event.end
        if event.shared is not None:
            fork.run.shared = (fork.run.shared or 0.0) + event.shared
        if event.end.outcome != "failed":
            places = {seen.index: place_of(seen, self._sources) for seen in event.sites}
            fork.run.observations[test] = observation(event.end, places)
        yield from self._settle(event.mutant)

    def _test_ended(self, end: TestEnd) -> Iterator[Outcome]:
        """The parent has run a test: the second opinion on the original."""
        undiverged = self._undiverged.pop(end.test, {})
        if end.lasting != self._baseline.ends[self._round, end.test].lasting:
            self._is_off = True
            self._parents.suspects.append((self._round, end.test))
        if self._is_off:
            return
        found = observation(end, self._places)
        self._baseline.compare_runs(self._round, end, found, self._campaign.request.vocabulary)
        if self._campaign.evidence is not None:
            self._campaign.evidence.add_again(self._round, end)
        own = replace(end, hits=0, acted=0, wall=0.0, cpu=0.0, trace=(), recording=None)
        self._own_ends.append(own)
        for mutant in undiverged.keys() & self._open.keys():
            self._open[mutant].ends.setdefault(end.test, replace(own, hits=undiverged[mutant]))
            self._open[mutant].run.observations.setdefault(end.test, found)
        for mutant in self._waiting.pop(len(self._own_ends) - 1, set()) & self._open.keys():
            yield from self._settle(mutant)

    def _settle(self, mutant: str) -> Iterator[Outcome]:
        """Yield the mutant's outcome if all that it depends on is known."""
        fork = self._open[mutant]
        is_dead = fork.run.death is not None
        is_decided = any(end.is_decided for end in fork.ends.values())
        is_over = is_dead or fork.run.exit_code is not None
        if not is_over and (not is_decided or self._campaign.request.every_test):
            return
        died_in = fork.run.death.test if fork.run.death is not None else None
        forked = fork.forked if fork.forked is not None else self._numbers.get(died_in or "", -1)
        # a survivor is compared with the original in all tests: those that the parent runs later, too
        last = forked if is_decided or is_dead else len(self._tests) - 1
        if last < len(self._own_ends):
            yield self._judged(fork, max(0, forked))
        else:
            self._waiting.setdefault(last, set()).add(mutant)

    def _judged(self, fork: _ForkedRun, shared: int) -> Outcome:
        """The outcome of a mutant that has so many tests from its parent."""
        run = fork.run
        ends = {end.test: end for end in self._own_ends[:shared]} | fork.ends
        run.ends = [ends[test] for test in self._tests if test in ends]
        run.wall = sum(end.wall for end in run.ends)
        if run.exit_code is not None:
            text = not_run({*self._tests} - run.left_out, run.ends, run.exit_code)
            run.death = Death(text) if text is not None else run.death
        outcome = judged(self._campaign, run)
        del self._open[run.mutant.id]
        return outcome


def _death_of(event: ForkDied) -> Death:
    during = f" during {event.test}" if event.test else ""
    return Death(
        text=f"{event.overdue or how_ended(event.exit_code)}{during}",
        test=event.test or None,
        signal=-event.exit_code if event.exit_code < 0 and event.overdue is None else None,
        overdue=event.overdue is not None,
        acted=event.acted,
        in_mutated_call=event.in_mutated_call,
        hindered=event.hindered,
        is_starved=event.is_starved,
    )
