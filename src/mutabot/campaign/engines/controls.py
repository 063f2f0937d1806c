"""Controls: mutants that must survive, and mutants that must die.

The identity mutant goes through all the machinery and changes nothing, so it must survive. The fatal mutant
raises, so it must die, which proves that turning a mutant on changes anything at all. A control that ends
wrongly is tried again in a fresh process; one that ends wrongly there too stops the campaign: its verdicts
could not be believed.

There is one pair for each engine and each way into the program: mutants of calls, of the program text, and of
each other provider have their own. Those of the text ask at their place like any alternative: the identity
proves by its hits that the text which runs is the instrumented one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.faults.providers import provider
from mutabot.campaign.verdict import judge
from mutabot.errors import ControlError
from mutabot.execution.task import Task
from mutabot.families import CONTROL
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.mutant import Place
from mutabot.operators.command import Fatal, Identity

from .fresh import REPLAY, run_of, task

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
    def way(self) -> tuple[str, str, bool, int]:
        """What it proves of an engine, wherever it acts."""
        return self.name, self.provider, self.subject == IMPORT, self.round

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
    """Run by replay the controls for these mutants.

    Raises ControlError for a control that ends wrongly, after it was yielded.
    """
    progress = campaign.progress
    found = controls_of(campaign.baseline, mutants)
    controls = [one for one in found if (REPLAY, one.way) not in campaign.proven]
    if not controls:
        return
    progress.stage("controls", len(controls))
    for control, outcome in _replayed(campaign, controls):
        end = end_of(campaign, control, outcome)
        progress.advance(f"{control.name}, {control.subject}: {'as it must' if end.ok else end.detail}")
        yield end
        if not end.ok:
            raise control.error(end.detail)
        campaign.proven.add((REPLAY, control.way))


def controls_of(baseline: Baseline, mutants: Iterable[Mutant], *, forked: bool = False) -> list[Control]:
    """One pair for each way into the program, where a mutant is planned; of ladders, one in each round.

    What raises while the program is imported says little about what is reached in a test: that comes last.
    Only a test that passes on the original must fail by the fatal one; one that may fail need not.
    ``forked``: those for processes that are forked at the place; what is forked before any test has an
    identity of its own.
    """
    mutants = [one for one in mutants if not forked or baseline.why_apart(one) is None]
    planned = {Place.of(mutant) for mutant in mutants}
    always = set(range(len(baseline.tests))) if any(one.ladder for one in mutants) else set()
    chosen: dict[tuple[tuple[str, bool], int], tuple[tuple[bool, float], Place, str]] = {}
    for (round, place), tests in baseline.reaching.items():
        passing = [test for test in tests if baseline.ends[round, test].outcome == "passed"]
        if not passing or place not in planned or (forked and _has_processes(baseline, round, tests)):
            continue
        is_early = place in baseline.early
        cost = (is_early, min(baseline.ends[round, test].wall for test in passing))
        key = ((baseline.faults.provider_at(place), forked and is_early), round)
        if key not in chosen or cost < chosen[key][0]:
            chosen[key] = (cost, place, passing[0])
    first = {way: min(round for other, round in chosen if other == way) for way, _ in chosen}
    return [
        Control(
            name, place, way[0], round, baseline.suite(round), IMPORT if way[1] else test.partition("::")[0]
        )
        for (way, round), (_, place, test) in chosen.items()
        if round == first[way] or round in always
        for name in ((IDENTITY,) if way[1] and (way[0], False) in first else (IDENTITY, FATAL))
    ]


def _has_processes(baseline: Baseline, round: int, tests: Iterable[str]) -> bool:
    return any(baseline.ends[round, test].processes for test in tests)


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
