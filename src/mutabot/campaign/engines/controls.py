"""Controls: mutants whose verdict is known, run to check that verdicts can be trusted.

The identity changes nothing, so it must have no effect. The fatal mutant raises, so it must be killed, make
the suite wait for ever, or, where the suite lets that pass, make other calls, returns or ends of tests than
the original: turning a mutant on changes something.

A control of replay that ends wrongly is tried again in a process that shares nothing. One that ends wrongly
there too stops the campaign: its verdicts could not be believed. What a fork shows is overruled by nothing:
where a control of theirs ended wrongly, forks are not believed from its test on, and replay, which has
controls of its own, judges. Each test in which mutants are forked has controls of its own, see
``runtime.isolation.fork_parent``: an identity beside the mutants of each moment, up to the end of the test.

Each way of running has one pair: each provider by each engine, and forks before any test. Controls of the
program text ask at their place like any alternative: the hits of the identity prove that instrumented text
runs.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from operator import methodcaller
from typing import TYPE_CHECKING

from mutabot.campaign.faults.providers import provider
from mutabot.campaign.verdict import judge, run_of
from mutabot.config.options import FORK, REPLAY
from mutabot.errors import ControlError
from mutabot.families import CALLS, CONTROL
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.mutant import Place
from mutabot.model.outcome_text import first_line
from mutabot.operators.command import Fatal, Identity

if TYPE_CHECKING:
    from mutabot.campaign.baseline.baseline import Baseline
    from mutabot.campaign.campaign import Campaign, MutantRun

IDENTITY, FATAL = Identity.name, Fatal.name
#: what a control is run for that is forked before any test
IMPORT = "the program's imports"


@dataclass(frozen=True, slots=True)
class Control:
    """A control to run.

    Attributes:
        name: which of the two, as an operator.
        place: where it acts.
        provider: the provider whose mutants it is run for.
        round: the round it is run in.
        tests: the tests to run.
        subject: name of what it is run for.
    """

    name: str
    place: Place
    provider: str
    round: int
    tests: tuple[str, ...]
    subject: str

    @property
    def way(self) -> tuple[str, str, bool]:
        """The provider and the way of running that the control checks, wherever it acts."""
        return self.name, self.provider, self.subject == IMPORT

    @property
    def mutant(self) -> Mutant:
        """The control as a mutant, whose id includes what it checks."""
        place = self.place
        return Mutant(
            0, CONTROL, self.name, place.site, place.operation, place.pattern, None, self.subject, self.name,
            provider=self.provider,
        )  # fmt: skip

    @property
    def run(self) -> MutantRun:
        """The control as a run for an engine."""
        return self.mutant, self.round

    def end(self, outcome: Outcome) -> ControlEnd:
        """Return the end of the control, as the journal keeps it."""
        wrong = self.what_is_wrong(outcome)
        return ControlEnd(self.subject, self.name, wrong is None, wrong or f"{outcome.hits} hits")

    def what_is_wrong(self, outcome: Outcome) -> str | None:
        """Return why the control did not end as it must; None if it did."""
        # a suite that waits for ever for what the fatal one has ended shows as well that it acted
        right = (Verdict.NO_EFFECT,) if self.name == IDENTITY else (Verdict.KILLED, Verdict.TIMEOUT)
        if outcome.verdict in right:
            return None
        if self.name == FATAL and outcome.verdict is Verdict.SURVIVED:
            if outcome.divergence:  # the suite lets pass what it changed
                return None
            return f"the test passes although the {provider(self.provider).location} raises"
        return f"{outcome.verdict}: {first_line(outcome.message or 'it changed something')}"


@dataclass(frozen=True, slots=True)
class _Candidate:
    """A test where a pair of controls could act; ``first`` is the number of the first test at its place."""

    round: int
    is_apart: bool
    is_early: bool
    has_processes: bool
    seconds: float
    first: int
    place: Place
    test: str

    def rank(self, *, forked: bool, as_late_as_possible: bool) -> tuple[float, ...]:
        """Return the sort key of a candidate; the lowest is the best.

        What raises while the program is imported, or in another process, says little of other tests.
        """
        if as_late_as_possible:
            return self.round, self.has_processes, -self.first
        if forked:
            return self.round, self.first
        return self.round, self.is_apart, self.is_early, self.has_processes, self.seconds


def controls_of(baseline: Baseline, mutants: Iterable[Mutant], *, forked: bool = False) -> list[Control]:
    """Return a pair of controls for each provider with mutants, in the quickest test of the first round.

    Only a test that passes on the original must fail by the fatal one. ``forked``: for processes that are
    forked at the place. Theirs are forked in the first test that reaches one, and the identity runs all that
    come after. What is forked before any test has an identity of its own, which runs the whole suite; the
    other pair is then forked as late as possible, when there is most that a fork could share.
    """
    apart: dict[Place, bool] = {}  # of several mutants at a place, the first decides how its controls act
    for mutant in mutants:
        if not forked or not baseline.is_apart(mutant):
            apart.setdefault(Place.of(mutant), baseline.is_apart(mutant))
    numbers = [{test: number for number, test in enumerate(tests)} for tests in baseline.tests]
    found: dict[tuple[str, bool], list[_Candidate]] = {}
    for (round, place), tests in baseline.reaching.items():
        ends = [baseline.ends[round, test] for test in tests]
        passing = [end for end in ends if end.outcome == "passed"]
        if not passing or place not in apart:
            continue
        quickest, first = passing[0], min(map(numbers[round].__getitem__, tests))
        is_early = place in baseline.early
        has_processes = forked and any(end.processes for end in ends)
        seconds = min(end.wall for end in passing)
        facts = (round, apart[place], is_early, has_processes, seconds, first)
        candidate = _Candidate(*facts, place, quickest.test)
        way = (baseline.faults.providers.get(place, CALLS), forked and is_early)
        found.setdefault(way, []).append(candidate)
    controls: list[Control] = []
    for (by, early), candidates in found.items():
        has_other = (by, not early) in found
        wanted = {"forked": forked and not early, "as_late_as_possible": has_other and not early}
        candidate = min(candidates, key=methodcaller("rank", **wanted))
        subject = IMPORT if early else candidate.test.partition("::")[0]
        suite = baseline.suite(candidate.round)
        names = (IDENTITY,) if has_other and early else (IDENTITY, FATAL)
        controls += [Control(name, candidate.place, by, candidate.round, suite, subject) for name in names]
    return controls


def run_controls(campaign: Campaign, mutants: Iterable[Mutant]) -> Iterator[ControlEnd]:
    """Run by replay the controls for these mutants.

    Raises ControlError for a control that ends wrongly, after it was yielded.
    """
    found = controls_of(campaign.baseline, mutants)
    controls = [candidate for candidate in found if (REPLAY, *candidate.way) not in campaign.proven]
    if controls:
        campaign.progress.stage("controls", len(controls))
    for control, outcome in _replayed(campaign, controls):
        yield from _settled(campaign, control, outcome)


def _settled(campaign: Campaign, control: Control, outcome: Outcome) -> Iterator[ControlEnd]:
    """Yield the end of a control, which is tried again in a fresh process if it ended wrongly.

    Raises ControlError for a control that ends wrongly, after it was yielded.
    """
    wrong = control.what_is_wrong(outcome)
    if wrong is not None:
        with campaign.executor.apart() as executor:  # the other processes are at work meanwhile
            ((_, again),) = _replayed(replace(campaign, executor=executor), [control])
        first, wrong = wrong, control.what_is_wrong(again)
        if wrong is None:
            if outcome.test is not None:
                campaign.baseline.doubt(outcome.test)
            campaign.progress.note(
                f"the {control.name} control of {control.subject} ended wrongly once ({first}), but as it "
                "must when it was tried again"
            )
        outcome = again
    campaign.progress.advance(f"{control.name}, {control.subject}: {wrong or 'as expected'}")
    yield control.end(outcome)
    if wrong is not None:
        where, advice = "", ""
        if outcome.test is not None:
            where, advice = f" in {outcome.test}", "; if that test fails by chance or load, deselect it"
        raise ControlError(
            f"the {control.name} control of {control.subject} at {control.place.site.place} ended wrongly"
            f"{where}: {wrong}; no verdict of this campaign could be believed{advice}"
        )
    campaign.proven.add((REPLAY, *control.way))


class ForkTrust:
    """Decides by the controls among forks which outcomes of other forks can be trusted.

    Args:
        campaign: the campaign.
        controls: those that are forked now, by the ids of their mutants.

    Attributes:
        is_open: whether an outcome may depend on them; most come when that is over.
    """

    def __init__(self, campaign: Campaign, controls: Mapping[str, Control]) -> None:
        self._campaign, self._controls = campaign, controls
        self._awaited = set(controls)
        self.is_open = bool(controls)
        self._first = sys.maxsize  # number of the first test of which forks are not believed

    def take(self, outcome: Outcome) -> Iterator[ControlEnd]:
        """Note the end of a control, and yield it if it is right; a wrong one leaves its forks to replay."""
        control = self._controls[outcome.mutant]
        self._awaited.discard(outcome.mutant)
        wrong = control.what_is_wrong(outcome)
        if wrong is None:
            self._campaign.proven.add((FORK, *control.way))
            self.is_open = bool(self._awaited) or self._first < sys.maxsize
            yield control.end(outcome)
            return
        is_of_test = control.name == IDENTITY and outcome.test in control.tests
        self._distrust(control.tests.index(outcome.test or "") if is_of_test else 0)
        where = f" in {outcome.test}" if outcome.test is not None else ""
        which = "that and later tests" if is_of_test else "any test"
        self._campaign.progress.note(
            f"the {control.name} control of {control.subject} ended wrongly in a fork{where} "
            f"({wrong}): results of forks from {which} do not count; their mutants run in processes of their "
            "own"
        )

    def close(self) -> None:
        """Note that all forks have ended. If a control has not reported, no outcome of a fork counts."""
        if self._awaited:
            self._distrust(0)

    def _distrust(self, number: int) -> None:
        self._first = min(number, self._first)

    def awaits(self, mutant: Mutant, outcome: Outcome) -> bool:
        """Return whether an outcome depends on controls that have not ended yet.

        It does not if the test in which the mutant was forked has decided: that test has controls of its own.
        """
        if not self._awaited:
            return False
        baseline = self._campaign.baseline
        is_decided_there = outcome.test in baseline.tests_from_first_reach(outcome.round, mutant)[:1]
        return not outcome.verdict.is_killed or baseline.is_early(mutant) or not is_decided_there

    def believes(self, outcome: Outcome) -> bool:
        """Return whether all tests that an outcome depends on end in a fork as they do in the original."""
        if self._first == sys.maxsize:
            return True
        suite = self._campaign.baseline.suite(outcome.round)
        last = suite.index(outcome.test) if outcome.test in suite else len(suite) - 1
        return last < self._first


def _replayed(campaign: Campaign, controls: Iterable[Control]) -> Iterator[tuple[Control, Outcome]]:
    tasks = (
        replace(campaign.task(*control.run, control.tests, stop=control.name == FATAL), key=control)
        for control in controls
    )
    for result in campaign.executor.run(tasks):
        yield result.task.key, judge(campaign, run_of(result, campaign.sources))
