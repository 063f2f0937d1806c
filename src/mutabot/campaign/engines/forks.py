"""The engine that runs the suite once as the original and forks it where a mutant differs.

There is one fork parent per round, or several where places share nothing. A fork parent is the second run of
the original. What a fork reports counts only if all tests up to the one in which it was forked ended in its
parent as in the baseline. Mutants that were forked later are left to replay, as are those that could not be
forked, or got lost with their parent.
"""

from __future__ import annotations

import math
import pickle
import zlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING

from mutabot.campaign.baseline.baseline import observation
from mutabot.campaign.campaign import Campaign, MutantRun
from mutabot.campaign.verdict import Death, Run, judge_safely, not_judged, not_run, without_tests
from mutabot.config.options import FORK
from mutabot.errors import MutabotError
from mutabot.execution.interruption import Interruption
from mutabot.execution.task import Result, Task, how_ended
from mutabot.families import CONTROL
from mutabot.model import Instrumentation, Mutant, Outcome, events
from mutabot.model.activation import Activation, Key, at_test
from mutabot.model.deadline import Limit
from mutabot.model.job import Forking

if TYPE_CHECKING:
    from mutabot.campaign.comparison import Observation
    from mutabot.model.mutant import Place

#: seconds without any word from a fork parent, beyond what its tests and forks may take
_PATIENCE = 60.0
#: fewest mutants of a part, since each part runs the suite once more; and most parts for each place
_LEAST, _PARTS = 10, 16
#: a part with fewer mutants pays if its forks take this many times as long as its own tests; and the fewest
#: mutants then
_WORTH, _FEWEST = 4, 2
#: seconds that a fork takes at least
_FORK = 0.01
_UNLIKE = "it ends differently in a fork that changes nothing"
_MISSED = "a process that it started from a fork did not run the mutant"
#: the level at which zlib costs least
_QUICKLY = 1
#: short tests of a fork that are packed together, since they are much alike; long ones weigh more
_TOGETHER = 50
#: characters of a recording that weigh as much as a short test
_CHARACTERS = 1000

_HeldEnd = tuple[events.TestEnd, "Observation | None"]


@dataclass(slots=True)
class Unhandled:
    """The mutants that ``fork`` leaves to replay, with the reasons.

    Attributes:
        runs: mutants and rounds.
        apart: ids of mutants that need a process of their own, whatever their tests.
        reasons: test to why mutants cannot be forked in it.
        notes: messages about what else went wrong.
        suspects: (round, test) that ended otherwise in a fork parent than in the baseline.
    """

    runs: list[MutantRun] = field(default_factory=list)
    apart: set[str] = field(default_factory=set)
    reasons: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    suspects: list[tuple[int, str]] = field(default_factory=list)

    def why(self, mutant: Mutant) -> str:
        """Describe why a mutant is left over."""
        if mutant.id in self.apart:
            return "it is active before any point at which it could be forked"
        return "; ".join(dict.fromkeys([*self.reasons.values(), *self.notes]))


def run_forks(campaign: Campaign, runs: Iterable[MutantRun], left: Unhandled) -> Iterator[Outcome]:
    """Run mutants in rounds as forks, of one parent a round, or of several where places share nothing.

    Yields outcomes as they come. ``left`` is filled with what is left to replay.
    """
    baseline = campaign.baseline
    parents: dict[int, _ForkRound] = {}
    for mutant, round in runs:
        # a control that may not have a test of its own is no mutant of any test
        if mutant.family != CONTROL and not baseline.tests_reaching(round, mutant):
            yield without_tests(baseline, mutant, round)
            continue
        if round not in parents:  # also if nothing is forked in it: it is the second run
            parents[round] = _ForkRound(campaign, left, round)
        if baseline.is_apart(mutant):
            left.runs.append((mutant, round))
            left.apart.add(mutant.id)
        else:
            parents[round].add(mutant)
    # the text of all rounds alike, so that one fork server can serve them
    forked = {mutant.id: mutant for parent in parents.values() for mutant in parent.mutants}
    text = baseline.faults.instrumentation(forked.values())
    by_key = dict(enumerate(cut(list(parents.values()), campaign.executor.spread)))
    tasks = (parent.task(key, text) for key, parent in by_key.items())
    try:
        yield from _taken(campaign.executor.events(tasks), by_key)
    except Interruption:
        seconds = max((parent.seconds_awaited for parent in by_key.values()), default=0.0)
        is_awaited = lambda: any(parent.is_awaited for parent in by_key.values())  # noqa: E731
        yield from _taken(campaign.executor.rest(is_awaited, seconds), by_key)
        raise


def _taken(
    ended: Iterable[Result | tuple[Task, events.Event]], parents: Mapping[int, _ForkRound]
) -> Iterator[Outcome]:
    """Yield the outcomes that follow from the events of fork parents."""
    for event in ended:
        if isinstance(event, Result):
            yield from parents[event.task.key].finish(event)
        else:
            yield from parents[event[0].key].take(event[1])


def cut(parents: list[_ForkRound], places: int) -> list[_ForkRound]:
    """Split fork parents into parts for workers that share nothing, the longest first."""
    if places < 2 or not parents:
        return parents
    whole = sum(parent.seconds for parent in parents) or 1.0
    parts = [part for parent in parents for part in parent.parts(places * parent.seconds / whole)]
    return sorted(parts, key=lambda part: -part.seconds)


@dataclass(slots=True)
class _RunInForks(Run):
    """The outcome of one mutant, as far as it is known.

    Attributes:
        own: its tests that have ended, but for those in ``held`` and ``packed``.
        held: how its own tests ended and what is compared of them.
        weight: how much that is, in short tests.
        packed: the same of those before: all that were forked in a test wait for their parent to end it.
        forked: number of the test in which it was forked, as far as it has reported; -1: before any.
        is_decided: whether one of them has decided about the mutant.
    """

    own: dict[str, events.TestEnd] = field(default_factory=dict)
    held: list[_HeldEnd] = field(default_factory=list)
    weight: int = 0
    packed: list[bytes] = field(default_factory=list)
    forked: int | None = None
    is_decided: bool = False

    def hold(self, end: events.TestEnd, seen: Observation | None) -> None:
        """Add the end of a test of the mutant; ``seen`` is what is compared of it, if anything is."""
        self.held.append((end, seen))
        self.weight += 1 + len(end.trace) + len(end.recording or "") // _CHARACTERS
        if self.weight >= _TOGETHER:
            self.packed.append(zlib.compress(pickle.dumps(self.held), _QUICKLY))
            self.held.clear()
            self.weight = 0

    def unpack(self) -> None:
        """Unpack the ends of tests, which ``hold`` has packed to save memory."""
        unpacked = (pickle.loads(zlib.decompress(data)) for data in self.packed)  # packed here
        for end, seen in chain(*unpacked, self.held):
            self.own[end.test] = end
            if seen is not None:
                self.observations[end.test] = seen
        self.packed.clear()
        self.held.clear()


class _ForkRound:
    """The fork parent of one round and its forks."""

    def __init__(self, campaign: Campaign, left: Unhandled, round: int) -> None:
        self._campaign, self._left, self._round = campaign, left, round
        self._baseline, self._sources = self._campaign.baseline, self._campaign.sources
        self._open: dict[str, _RunInForks] = {}
        self._tests = self._baseline.suite(round)
        self._numbers = {test: number for number, test in enumerate(self._tests)}
        self._own_ends: list[events.TestEnd] = []
        self._is_off = False
        self._waiting: dict[int, set[str]] = {}
        self._undiverged: dict[str, Mapping[str, int]] = {}
        self._places: dict[int, Place] = {}
        self._alike: dict[str, int] = {}  # tests to how many of their controls ended as the original
        self._unlike: set[str] = set()

    def add(self, mutant: Mutant) -> None:
        """Add a mutant to fork."""
        self._open[mutant.id] = _RunInForks(mutant, self._round, self._tests, engine=FORK)

    @property
    def mutants(self) -> tuple[Mutant, ...]:
        """The mutants whose outcomes are not known yet."""
        return tuple(fork.mutant for fork in self._open.values())

    @property
    def seconds(self) -> float:
        """The longest time (s) that its tests and forks should take, by the baseline."""
        own = self._baseline.seconds(self._round, self._tests)
        return own * (1 + len(self._open)) + _FORK * len(self._open)

    @property
    def is_awaited(self) -> bool:
        """Whether ended forks wait for a test of this parent, or a control has not ended."""
        return not self._is_off and bool(self._awaited())

    @property
    def seconds_awaited(self) -> float:
        """The time (s) until no ended fork waits any more, by the baseline."""
        last = max(self._awaited(), default=-1)
        return self._baseline.seconds(self._round, self._tests[len(self._own_ends) : last + 1])

    def _awaited(self) -> list[int]:
        """Return the numbers of the tests that ended forks wait for; the last test's if a control runs."""
        awaited = [number for number, mutants in self._waiting.items() if mutants & self._open.keys()]
        is_controlled = any(mutant.family == CONTROL for mutant in self.mutants)
        return [*awaited, len(self._tests) - 1] if is_controlled else awaited

    def parts(self, places: float) -> list[_ForkRound]:
        """Split into fork parents with a part of the mutants each; what equal tests reach stays together."""
        worth = max(_FEWEST * places, len(self._open) / _WORTH)
        count = min(math.ceil(min(_PARTS * places, worth)), len(self._open) // _LEAST)
        if count < 2:
            return [self]
        reaching = self._baseline.tests_reaching
        mutants = sorted(self.mutants, key=lambda mutant: (reaching(self._round, mutant), mutant.id))
        found = [_ForkRound(self._campaign, self._left, self._round) for _ in range(count)]
        for number, mutant in enumerate(mutants):
            found[number * count // len(mutants)].add(mutant)
        return found

    def task(self, key: int, text: Instrumentation | None) -> Task:
        """Return the task that runs the fork parent."""
        campaign, baseline, mutants = self._campaign, self._baseline, self.mutants
        limits = campaign.limits(self._round, self._tests)
        forking = Forking(
            mutants=mutants,
            limits=limits,
            limit=max(limits.values(), key=lambda limit: limit.wall, default=campaign.startup_limit),
            startup=campaign.startup_limit,
            every_test=campaign.request.every_test,
            serial=baseline.is_exclusive(self._round),
            keys={mutant.id: self._keys(mutant) for mutant in mutants},
        )
        active = {mutant.id: baseline.faults.active(mutant) for mutant in mutants}
        job = campaign.job(
            self._round, self._tests, mutants, forking=forking, instrumentation=text, active=active
        )
        for fork in self._open.values():
            fork.left_out = job.left_out(fork.mutant.id)
        # it waits for forks that go to the end
        patience = Limit(
            2.0 * sum(limit.wall for limit in limits.values()) + forking.startup.wall + _PATIENCE
        )
        # else it forks while it imports the program
        may_share = baseline.may_share and not any(map(baseline.is_early, mutants))
        return Task(
            key, job, {}, patience, patience, is_fork_parent=True, may_share=may_share, alone=forking.serial
        )

    def _keys(self, mutant: Mutant) -> tuple[Key, ...]:
        """Return the keys at which a mutant is forked.

        In a test with processes below it that is its start: the mutant may be hit in them.
        """
        keys = self._baseline.faults.active(mutant).keys
        tests = [
            at_test(test)
            for test in self._baseline.tests_reaching(self._round, mutant)
            if Activation.EACH_TEST in keys or self._baseline.ends[self._round, test].processes
        ]
        # each once: a mutant is forked for each time that it stands at a key
        return tuple(dict.fromkeys([*(key for key in keys if key != Activation.EACH_TEST), *tests]))

    def take(self, event: events.Event) -> Iterator[Outcome]:
        """Process an event. Yield the outcomes that it settles.

        What goes wrong with it is an error of its mutant, or leaves its test to replay.
        """
        try:
            yield from self._take(event)
        except Exception as error:
            if isinstance(event, events.ForkTestEnd | events.ForkDied) and event.mutant in self._open:
                yield not_judged(self._open.pop(event.mutant).mutant, self._round, error, FORK)
                return
            if isinstance(error, MutabotError | OSError):
                raise
            text = f"a report of the fork parent cannot be used: {type(error).__name__}: {error}"
            self._left.notes.append(text)
            self._is_off = self._is_off or isinstance(event, events.TestEnd)

    def _take(self, event: events.Event) -> Iterator[Outcome]:
        match event:
            case events.ForkTestEnd() if event.mutant in self._open:
                yield from self._test_of_fork_ended(event)
            case events.ForkDied() if event.mutant in self._open:
                self._open[event.mutant].death = _death_of(event)
                yield from self._settle(event.mutant)
            case events.ForkSessionEnd():
                for mutant in self._open.keys() & set(event.mutants):
                    run = self._open[mutant]
                    run.exit_code, run.gone, run.has_acted = event.exit_code, event.gone, event.has_acted
                    run.death = Death("; ".join(event.errors)) if event.errors else run.death
                    yield from self._settle(mutant)
            case events.Unforked():
                self._left.reasons.setdefault(event.test, event.reason)
                self._leave(self._open.keys() & set(event.mutants))
            case events.ForkTestEnd() if event.is_test_control:
                end, original = event.end, self._baseline.ends[self._round, event.end.test]
                is_alike = end.lasting == original.lasting and not (end.acted or end.is_decided)
                self._alike[end.test] = self._alike.get(end.test, 0) + is_alike
            case events.TestControls() if self._alike.get(event.test, 0) < event.count:
                self._left.reasons.setdefault(event.test, _UNLIKE)
                self._unlike.add(event.test)
            case events.Undiverged():
                self._undiverged[event.test] = event.hits
            case events.SiteSeen():
                self._places |= self._sources.places([event])
            case events.TestEnd():
                yield from self._test_ended(event)
            case events.Untrusted():  # forks have files of their own: what is settled is not concerned
                self._left.notes.append(
                    f"round {self._round + 1}: {event.reason}; mutants that may have to do with it run in "
                    "processes of their own"
                )
                self._leave(list(self._open))

    def _leave(self, mutants: Iterable[str]) -> None:
        self._left.runs += [(self._open.pop(mutant).mutant, self._round) for mutant in mutants]

    def finish(self, result: Result) -> Iterator[Outcome]:
        """Settle what can be settled after the process has ended, and leave the rest to replay."""
        if result.end is None:
            self._left.notes.append(f"the fork parent of round {self._round + 1} died: {result.death()}")
        is_whole = len(self._own_ends) == len(self._tests) and not self._is_off
        simulated = [end.simulated for end in self._own_ends if end.simulated is not None]
        for fork in list(self._open.values()):
            # nothing differed: it was the mutant's run as well
            if is_whole and fork.own and fork.forked is None and fork.death is None:
                fork.exit_code = self._baseline.exits[self._round]
                fork.shared = sum(simulated) if simulated else None
                yield from self._outcomes_of(fork, len(self._tests))
        self._leave(list(self._open))

    def _test_of_fork_ended(self, event: events.ForkTestEnd) -> Iterator[Outcome]:
        fork, test = self._open[event.mutant], event.end.test
        if fork.forked is None:
            fork.forked = -1 if event.is_early else self._numbers.get(test, -1)
        fork.is_decided |= event.end.is_decided
        if event.shared is not None:
            fork.shared = (fork.shared or 0.0) + event.shared
        places = self._sources.places(event.sites)
        fork.hold(event.end, observation(event.end, places) if event.end.outcome != "failed" else None)
        yield from self._settle(event.mutant)

    def _test_ended(self, end: events.TestEnd) -> Iterator[Outcome]:
        """Compare a test that the parent has run with the baseline, and settle the outcomes that await it."""
        undiverged = self._undiverged.pop(end.test, {})
        if end.lasting != self._baseline.ends[self._round, end.test].lasting:
            self._is_off = True
            self._left.suspects.append((self._round, end.test))
        if self._is_off:
            return
        found = observation(end, self._places)
        self._baseline.compare_runs(self._round, end, found, self._campaign.request.vocabulary)
        if self._campaign.evidence is not None:
            self._campaign.evidence.add_rerun(self._round, end)
        own = replace(end, hits=0, acted=0, wall=0.0, cpu=0.0, trace=(), recording=None)
        self._own_ends.append(own)
        for mutant in undiverged.keys() & self._open.keys():
            self._open[mutant].own.setdefault(end.test, replace(own, hits=undiverged[mutant]))
            self._open[mutant].observations.setdefault(end.test, found)
        for mutant in self._waiting.pop(len(self._own_ends) - 1, set()) & self._open.keys():
            yield from self._settle(mutant)

    def _settle(self, mutant: str) -> Iterator[Outcome]:
        """Yield the mutant's outcome if all that it depends on is known."""
        fork = self._open[mutant]
        is_dead = fork.death is not None
        is_over = is_dead or fork.exit_code is not None
        if not is_over and (not fork.is_decided or self._campaign.request.every_test):
            return
        died_in = fork.death.test if fork.death is not None else None
        forked = fork.forked if fork.forked is not None else self._numbers.get(died_in or "", -1)
        # a survivor is compared with the original in all tests: those that the parent runs later, too
        last = forked if fork.is_decided or is_dead else len(self._tests) - 1
        if last < len(self._own_ends):
            if forked >= 0 and self._tests[forked] in self._unlike:
                self._leave([mutant])
            else:
                yield from self._outcomes_of(fork, max(0, forked))
        else:
            self._waiting.setdefault(last, set()).add(mutant)

    def _outcomes_of(self, run: _RunInForks, shared: int) -> Iterator[Outcome]:
        """Return the outcome of a mutant whose parent ran ``shared`` tests before the fork.

        It is left to replay if a process that a test started did not get it.
        """
        run.unpack()
        is_missed = partial(self._baseline.is_missed, self._round, run.mutant)
        missed = next((end.test for end in run.own.values() if is_missed(end)), None)
        if missed is not None:
            self._left.reasons.setdefault(missed, _MISSED)
            self._leave([run.mutant.id])
            return
        ends = {end.test: end for end in self._own_ends[:shared]} | run.own
        run.ends = [ends[test] for test in self._tests if test in ends]
        run.ends += [end for test, end in ends.items() if test not in self._numbers]
        run.wall = sum(end.wall for end in run.ends)
        if run.exit_code is not None:
            text = not_run({*self._tests} - run.left_out - {*run.gone}, run.ends, run.exit_code)
            run.death = Death(text) if text is not None else run.death
        del self._open[run.mutant.id]
        yield judge_safely(self._campaign, run)


def _death_of(event: events.ForkDied) -> Death:
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
