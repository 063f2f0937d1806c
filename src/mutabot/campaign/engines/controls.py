"""Controls: mutants that must survive, and mutants that must die.

The identity mutant goes through all the machinery and changes nothing, so it must survive. The fatal mutant
raises, so it must die; it is run once per test file and proves that turning a mutant on changes anything at
all. A control that ends wrongly is tried again in a fresh process; one that ends wrongly there too stops the
campaign: its verdicts could not be believed.

Mutants that take different ways into the program (as those of calls and those of the program text do) have
controls of their own. Those of the text ask at their place like any alternative: the identity proves by its
hits that the text which runs is the instrumented one.

For the replay engine the identity mutant is run with every selection of tests that a mutant will be judged
by, which also finds tests that pass only after others: their mutants are then judged by the whole suite. For
the branch engine, whose trunk runs the whole suite anyway, it is run in every test.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.faults.providers import provider
from mutabot.campaign.workers.task import Task
from mutabot.errors import ControlError
from mutabot.families import CONTROL
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.place import Place
from mutabot.operators.control import Fatal, Identity

from .fresh import run_of, task
from .judge import judge

IDENTITY, FATAL = Identity.name, Fatal.name


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
    def mutant(self) -> Mutant:
        """The control as a mutant; what it is run for is part of its id."""
        place = self.place
        variant = self.subject if self.round == 0 else f"{self.subject}, round {self.round + 1}"
        return Mutant(
            0, CONTROL, self.name, place.site, place.operation, place.pattern, None, variant, self.name,
            provider=self.provider,
        )  # fmt: skip

    def task(self, campaign: Campaign) -> Task:
        """The task that runs it by replay."""
        made = task(campaign, self.mutant, self.round, self.tests, stop=self.name == FATAL)
        return replace(made, key=self)

    def end(self, outcome: Outcome) -> ControlEnd:
        """How it ended, judged by its outcome."""
        wrong = self._what_is_wrong(outcome)
        return ControlEnd(self.subject, self.name, wrong is None, wrong or f"{outcome.hits} hits")

    def _what_is_wrong(self, outcome: Outcome) -> str | None:
        expected = Verdict.NO_EFFECT if self.name == IDENTITY else Verdict.KILLED
        if outcome.verdict is expected:
            return None
        if self.name == FATAL and outcome.verdict is Verdict.SURVIVED:
            return f"the test passes although the {provider(self.provider).location} raises"
        where = f"; it was at {outcome.stuck}" if outcome.stuck is not None else ""
        return f"{outcome.verdict}: {outcome.message or 'it changed something'}{where}"

    def error(self, wrong: str) -> ControlError:
        """The error that stops the campaign."""
        return ControlError(
            f"the {self.name} control of {self.subject} at {self.place.site.place} ended wrongly: "
            f"{wrong}; no verdict of this campaign could be believed",
            control=self.name,
            test_file=self.tests[0].partition("::")[0],
        )


def run_controls(campaign: Campaign, mutants: Iterable[Mutant]) -> Iterator[ControlEnd]:
    """Run by replay the controls for these mutants; tells the baseline which tests need the whole suite.

    Raises ControlError for a control that ends wrongly, after it was yielded.
    """
    baseline, progress = campaign.baseline, campaign.progress
    mutants = list(mutants)
    identities = [one for one in _identities_by_selection(baseline, mutants) if one not in campaign.proven]
    fatals = [one for one in _fatals(baseline, mutants) if one not in campaign.proven]
    if not identities and not fatals:
        return
    progress.stage("controls", len(identities) + len(fatals))
    together: list[Control] = []
    for control, outcome in _replayed(campaign, identities):
        end = end_of(campaign, control, outcome)
        ended = "survives, as it must" if end.ok else end.detail
        progress.advance(f"{control.name}, {control.subject}: {ended}")
        if end.ok:
            campaign.proven.add(control)
            yield end
        elif set(control.tests) == set(baseline.tests[control.round]):
            yield end
            raise control.error(end.detail)
        else:
            baseline.passes_only_together(control.tests)
            together.append(_with_whole_suite(control, baseline))
            progress.note(f"{control.subject} pass only after other tests: judged by the whole suite")
    # only now is it known which selections pass by themselves
    campaign.proven.update(fatals)  # one that ends wrongly stops the campaign
    fatals = [replace(fatal, tests=baseline.selection(fatal.round, fatal.place)) for fatal in fatals]
    for control, outcome in _replayed(campaign, [*together, *fatals]):
        end = end_of(campaign, control, outcome)
        progress.advance(f"{control.name}, {control.subject}: {'as it must' if end.ok else end.detail}")
        yield end
        if not end.ok:
            raise control.error(end.detail)


def controls_in_branches(
    baseline: Baseline, mutants: Iterable[Mutant], rounds: Iterable[int] = (0,)
) -> list[Control]:
    """The controls to run as branches: identity in every test of these rounds, fatal once per file."""
    mutants = [mutant for mutant in mutants if baseline.why_apart(mutant) is None]
    planned = _places(mutants)
    ways = {baseline.faults.provider_at(place) for place in planned}
    uncovered = {(way, one): set(baseline.tests[one]) for way in ways for one in rounds}
    found: list[Control] = []
    for (round, place), tests in baseline.reaching.items():
        way = baseline.faults.provider_at(place)
        missing = uncovered.get((way, round), set())
        here = tuple(test for test in tests if test in missing)
        here = tuple(test for test in here if baseline.why_not_branch(round, [test]) is None)
        if here and place in planned and place not in baseline.early:
            missing -= set(here)
            found.append(Control(IDENTITY, place, way, round, here, _subject(here)))
    fatals = _fatals(baseline, mutants)
    return [*found, *(one for one in fatals if baseline.why_not_branch(one.round, one.tests) is None)]


def end_of(campaign: Campaign, control: Control, outcome: Outcome) -> ControlEnd:
    """How a control ended. One that ended wrongly is tried again in a process that shares nothing."""
    end = control.end(outcome)
    if end.ok:
        return end
    with campaign.executor.apart() as executor:  # the other processes are at work meanwhile
        ((_, again),) = _replayed(replace(campaign, executor=executor), [control])
    second = control.end(again)
    if not second.ok:
        return second
    if outcome.test is not None:
        campaign.baseline.doubt(outcome.test)
    campaign.progress.note(
        f"the {control.name} control of {control.subject} ended wrongly once ({end.detail}), but as it must "
        "when it was tried again"
    )
    return second


def _replayed(campaign: Campaign, controls: Iterable[Control]) -> Iterator[tuple[Control, Outcome]]:
    for result in campaign.executor.run(control.task(campaign) for control in controls):
        control: Control = result.task.key
        yield control, judge(campaign, run_of(result, campaign.sources))


def _identities_by_selection(baseline: Baseline, mutants: list[Mutant]) -> list[Control]:
    """One identity control per selection of tests that mutants are judged by, for ladders in each round."""
    chosen: dict[tuple[str, tuple[str, ...], int], Control] = {}
    for round in range(len(baseline.tests)):
        for mutant in mutants:
            place = Place.of(mutant)
            tests = baseline.judges(round, mutant)
            if tests:
                way = baseline.faults.provider_at(place)
                control = Control(IDENTITY, place, way, round, tests, _subject(tests))
                chosen.setdefault((way, tests, round if mutant.ladder else 0), control)
    return list(chosen.values())


def _places(mutants: Iterable[Mutant]) -> set[Place]:
    """All places at which these mutants act."""
    return set(map(Place.of, mutants))


def _subject(tests: tuple[str, ...]) -> str:
    return tests[0] if len(tests) == 1 else f"{tests[0]} and {len(tests) - 1} more"


def _fatals(baseline: Baseline, mutants: list[Mutant]) -> list[Control]:
    """One fatal control per test file: its quickest test, at a site where a mutant is planned.

    What raises while the program is imported says little about what is reached in a test: that comes last.
    Only a test that passes on the original must fail by it; one that may fail, or skips itself, need not.
    """
    planned, early = _places(mutants), baseline.early
    chosen: dict[tuple[str, str], Control] = {}
    costs: dict[tuple[str, str], tuple[bool, int, float]] = {}
    for (round, place), tests in baseline.reaching.items():
        passing = [test for test in tests if baseline.ends[round, test].outcome == "passed"]
        for test in passing if place in planned else ():
            key = (baseline.faults.provider_at(place), test.partition("::")[0])
            cost = (place in early, round, baseline.ends[round, test].wall)
            if key not in costs or cost < costs[key]:
                costs[key] = cost
                chosen[key] = Control(FATAL, place, key[0], round, (test,), key[1])
    return list(chosen.values())


def _with_whole_suite(control: Control, baseline: Baseline) -> Control:
    tests = tuple(baseline.tests[control.round])
    return replace(control, tests=tests, subject="the whole suite")
