"""Controls: mutants of mutabot's own whose end is known.

The identity changes nothing, so it must survive. The fatal mutant raises, so it must die, or make the suite
wait for ever: turning a mutant on changes something. A control that ends wrongly is tried again in a fresh
process. One that ends wrongly there too stops the campaign: its verdicts could not be believed.

Each way of running has one pair: each provider by each engine, and forks before any test. Controls of the
program text ask at their place like any alternative: the hits of the identity prove that instrumented text
runs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TYPE_CHECKING

from mutabot.campaign.faults.providers import provider
from mutabot.campaign.request import REPLAY
from mutabot.campaign.verdict import judge, run_of
from mutabot.errors import ControlError
from mutabot.families import CALLS, CONTROL
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.mutant import Place
from mutabot.operators.command import Fatal, Identity

if TYPE_CHECKING:
    from mutabot.campaign.baseline.baseline import Baseline
    from mutabot.campaign.campaign import Campaign, MutantRun

IDENTITY, FATAL = Identity.name, Fatal.name
#: what a control is run for that is forked before any test
IMPORT = "the program's imports"


@dataclass(frozen=True, slots=True)
class Control:
    """One control to run.

    Attributes:
        name: which of the two, as an operator.
        place: where it acts.
        provider: the provider whose mutants it is run for.
        round: the round it is run in.
        tests: the tests to run.
        subject: what it is run for, in words.
    """

    name: str
    place: Place
    provider: str
    round: int
    tests: tuple[str, ...]
    subject: str

    @property
    def way(self) -> tuple[str, str, bool]:
        """What it proves of an engine, wherever it acts."""
        return self.name, self.provider, self.subject == IMPORT

    @property
    def mutant(self) -> Mutant:
        """The control as a mutant. What it is run for is part of its id."""
        place = self.place
        return Mutant(
            0, CONTROL, self.name, place.site, place.operation, place.pattern, None, self.subject, self.name,
            provider=self.provider,
        )  # fmt: skip

    @property
    def run(self) -> MutantRun:
        """The control as what an engine runs."""
        return self.mutant, self.round

    def what_is_wrong(self, outcome: Outcome) -> str | None:
        """Why its end is not the one that it must have; None if it is."""
        # a suite that waits for ever for what the fatal one has ended shows as well that it acted
        right = (Verdict.NO_EFFECT,) if self.name == IDENTITY else (Verdict.KILLED, Verdict.TIMEOUT)
        if outcome.verdict in right:
            return None
        if self.name == FATAL and outcome.verdict is Verdict.SURVIVED:
            return f"the test passes although the {provider(self.provider).location} raises"
        return f"{outcome.verdict}: {outcome.message or 'it changed something'}"


@dataclass(frozen=True, slots=True)
class _Candidate:
    """Where a pair of controls could act: ``first`` is the number of the first test that reaches it."""

    round: int
    is_early: bool
    seconds: float
    first: int
    place: Place
    test: str

    @property
    def by_time(self) -> tuple[int, bool, float]:
        """What raises while the program is imported says little about what is reached in a test."""
        return self.round, self.is_early, self.seconds

    @property
    def by_lateness(self) -> tuple[int, int]:
        return self.round, -self.first


def controls_of(baseline: Baseline, mutants: Iterable[Mutant], *, forked: bool = False) -> list[Control]:
    """One pair for each provider, where a mutant is planned, in the quickest test of the first round.

    Only a test that passes on the original must fail by the fatal one. ``forked``: for processes that are
    forked at the place. What is forked before any test has an identity of its own, which runs the whole
    suite; the other pair is then forked as late as possible, when there is most that a fork could share.
    """
    planned = {Place.of(one) for one in mutants if not forked or not baseline.is_apart(one)}
    numbers = [{test: number for number, test in enumerate(tests)} for tests in baseline.tests]
    found: dict[tuple[str, bool], list[_Candidate]] = {}
    for (round, place), tests in baseline.reaching.items():
        ends = [baseline.ends[round, test] for test in tests]
        passing = [end for end in ends if end.outcome == "passed"]
        if not passing or place not in planned or (forked and any(end.processes for end in ends)):
            continue
        quickest, first = passing[0], min(map(numbers[round].__getitem__, tests))
        is_early = place in baseline.early
        one = _Candidate(round, is_early, min(end.wall for end in passing), first, place, quickest.test)
        way = (baseline.faults.providers.get(place, CALLS), forked and is_early)
        found.setdefault(way, []).append(one)
    controls: list[Control] = []
    for (by, early), candidates in found.items():
        has_other = (by, not early) in found
        one = min(candidates, key=attrgetter("by_lateness" if has_other and not early else "by_time"))
        names = (IDENTITY,) if has_other and early else (IDENTITY, FATAL)
        subject = IMPORT if early else one.test.partition("::")[0]
        suite = baseline.suite(one.round)
        controls += [Control(name, one.place, by, one.round, suite, subject) for name in names]
    return controls


def run_controls(campaign: Campaign, mutants: Iterable[Mutant]) -> Iterator[ControlEnd]:
    """Run by replay the controls for these mutants.

    Raises ControlError for a control that ends wrongly, after it was yielded.
    """
    found = controls_of(campaign.baseline, mutants)
    controls = [one for one in found if (REPLAY, *one.way) not in campaign.proven]
    if controls:
        campaign.progress.stage("controls", len(controls))
    for control, outcome in _replayed(campaign, controls):
        yield from settled(campaign, REPLAY, control, outcome, is_step=True)


def settled(
    campaign: Campaign, engine: str, control: Control, outcome: Outcome, *, is_step: bool = False
) -> Iterator[ControlEnd]:
    """The end of a control. One that ended wrongly is tried again in a process that shares nothing.

    ``is_step``: whether the present stage counts controls.

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
    if is_step:
        campaign.progress.advance(f"{control.name}, {control.subject}: {wrong or 'passed'}")
    yield ControlEnd(control.subject, control.name, wrong is None, wrong or f"{outcome.hits} hits")
    if wrong is not None:
        raise ControlError(
            f"the {control.name} control of {control.subject} at {control.place.site.place} ended wrongly: "
            f"{wrong}; no verdict of this campaign could be believed"
        )
    campaign.proven.add((engine, *control.way))


def _replayed(campaign: Campaign, controls: Iterable[Control]) -> Iterator[tuple[Control, Outcome]]:
    tasks = (replace(campaign.task(*one.run, one.tests, stop=one.name == FATAL), key=one) for one in controls)
    for result in campaign.executor.run(tasks):
        yield result.task.key, judge(campaign, run_of(result, campaign.sources))
