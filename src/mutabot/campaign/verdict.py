"""Decide the verdict of a mutant in a round, from what either engine saw of it."""

from __future__ import annotations

import traceback
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.campaign.baseline.baseline import Baseline, Sources, observation
from mutabot.campaign.comparison import Difference, Observation, compare, farthest
from mutabot.campaign.faults.providers import provider
from mutabot.errors import MutabotError, in_short
from mutabot.model import By, Kill, Looked, Mutant, Outcome, Verdict
from mutabot.model.codec import shallow
from mutabot.model.event_file import OWN_FAULT
from mutabot.model.events import TestEnd
from mutabot.model.outcome import added
from mutabot.model.outcome_text import outcome_text
from mutabot.model.source_units import Executed, together

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign
    from mutabot.execution.task import Result

#: tests of a survivor whose checks are kept
_MOST_LOOKED = 20
#: tests of which it is kept how they differ from the original's
_MOST_DIVERGED = 5
_NOT_REACHED = "no test reaches the site in this round"
_RECORDED = frozenset({Verdict.SURVIVED, Verdict.KILLED, Verdict.TIMEOUT, Verdict.REFUSED, Verdict.GUARDED})

Ruling = tuple[Verdict, TestEnd | None, str | None]


@dataclass(slots=True)
class Death:
    """How a process ended that did not run its tests to their end.

    Attributes:
        text: description.
        test: the test it was in, or None.
        signal: the signal that killed it, or None.
        overdue: whether its wall-clock time was up.
        acted: whether its mutant had changed anything by then.
        in_mutated_call: whether it was in the midst of a mutated call.
        hindered: why that says little of it, as the machine was busy; None if it was not.
        is_starved: whether it was ended although it had not had its time.
    """

    text: str
    test: str | None = None
    signal: int | None = None
    overdue: bool = False
    acted: bool = False
    in_mutated_call: bool = False
    hindered: str | None = None
    is_starved: bool = False


@dataclass(slots=True)
class Run:
    """What was seen of a mutant in a round.

    Attributes:
        mutant, round: which.
        tests: the tests that judge it, in order.
        ends: how they ended, in this order, up to the one that decided; all of them where each is to run.
        observations: what is compared of each test that passed.
        death: set if a process did not live to the end of its tests.
        wall: seconds spent on it.
        shared: simulated seconds that it did not have to spend, since the original had.
        engine: ``replay`` or ``fork``.
        exit_code: how the process ended after the whole session; None if it did not get that far.
        problem: why nothing is known of the mutant, or None: it was not there, or reports cannot be trusted.
        left_out: tests that it was to leave out, unless the original has run them for it.
        gone: tests that are not collected since it changed something.
        has_acted: whether it changed anything, as far as the session reports at its end.
    """

    mutant: Mutant
    round: int
    tests: tuple[str, ...]
    ends: list[TestEnd] = field(default_factory=list)
    observations: dict[str, Observation] = field(default_factory=dict)
    death: Death | None = None
    wall: float = 0.0
    shared: float | None = None
    engine: str = "replay"
    exit_code: int | None = None
    problem: str | None = None
    left_out: frozenset[str] = frozenset()
    gone: tuple[str, ...] = ()
    has_acted: bool = False

    @property
    def hindered(self) -> str | None:
        """Why the wall-clock limit that ended the run is inconclusive; None if no such limit ended it."""
        deaths = [self.death.hindered] if self.death is not None else []
        return next((why for why in (*deaths, *(end.hindered for end in self.ends)) if why is not None), None)


def run_of(result: Result, sources: Sources) -> Run:
    """Return what a worker saw of its mutant."""
    job = result.task.job
    assert job.mutant is not None
    places = sources.places(result.sites)
    left_out = job.left_out(job.mutant.id)
    not_there = (f"{file}: {why}" for file, why in result.not_instrumented.items())
    return Run(
        mutant=job.mutant,
        round=job.round,
        tests=job.tests or (),
        left_out=left_out,
        ends=result.ends,
        observations={end.test: observation(end, places) for end in result.ends if end.outcome != "failed"},
        death=_death_in(result, {*(job.tests or ())} - left_out),
        exit_code=result.exit_code if result.end is not None else None,
        problem=result.untrusted if result.untrusted is not None else next(not_there, None),
        wall=result.wall,
        gone=result.end.gone if result.end is not None else (),
        has_acted=result.end is not None and result.end.has_acted,
    )


def _death_in(result: Result, tests: Collection[str]) -> Death | None:
    """Return how the process died; None if it ran all its tests, or stopped at a verdict."""
    if result.end is None:
        text: str | None = result.death()
    elif result.end.errors:
        text = "; ".join(result.end.errors)
    else:
        text = not_run(set(tests).difference(result.end.gone), result.ends, result.exit_code)
    if text is None:
        return None
    return Death(
        text=text,
        test=result.running,
        signal=-result.exit_code if result.end is None and result.exit_code < 0 else None,
        overdue=result.overdue is not None and (result.running is not None or "" in result.acted),
        acted=not {result.running, ""}.isdisjoint(result.acted),
        in_mutated_call=result.in_mutated_call,
        hindered=result.hindered,
        is_starved=result.is_starved,
    )


def not_run(tests: Collection[str], ends: Collection[TestEnd], exit_code: int) -> str | None:
    """Return why tests have no end although the session ended; None if the exit code says enough.

    A suite that ends early, and says so by its exit code, has ended otherwise than on the original.
    """
    missing = set(tests) - {end.test for end in ends}
    if not missing or any(end.is_decided for end in ends) or exit_code not in (0, 1):
        return None
    return f"{len(missing)} tests did not run, such as {min(missing)}"


def without_tests(baseline: Baseline, mutant: Mutant, round: int) -> Outcome:
    """Return the outcome of a mutant that no test can judge in this round."""
    missing = baseline.missing_judges(round, mutant)
    if missing:
        text = f"no reliable test reaches the site; {_might_have_failed(missing)}"
        return Outcome(mutant.id, round, Verdict.UNSTABLE, message=text)
    return Outcome(mutant.id, round, Verdict.NOT_COVERED, message=_NOT_REACHED, executed={})


def _might_have_failed(missing: Mapping[str, str]) -> str:
    """Return which tests might have noticed a mutant, and why the first of them is no judge of it."""
    return f"{in_short([*missing], 1)} might have failed: {next(iter(missing.values()))}"


def judge_safely(campaign: Campaign, run: Run) -> Outcome:
    """Return the outcome of a run; its recordings are kept as far as they differ from the original's.

    What goes wrong while it is judged is an error of this mutant, and not the end of the campaign. An outcome
    with ``beside`` was ended by a limit of wall clock on a busy machine: it is to be run once more alone.
    """
    try:
        outcome = _with_recordings(campaign, run)
    except Exception as error:
        return not_judged(run.mutant, run.round, error, run.engine)
    beside = f"{outcome_text(outcome)}; {run.hindered}" if run.hindered is not None else None
    return replace(outcome, beside=beside)


def not_judged(mutant: Mutant, round: int, error: Exception, engine: str) -> Outcome:
    """Return the outcome of a mutant that could not be judged; other errors are raised again."""
    if isinstance(error, MutabotError | OSError):  # it says something of the user's set-up or of the disk
        raise error
    where = traceback.extract_tb(error.__traceback__)[-1]
    text = f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
    message = f"mutabot could not judge what it saw of it: {text}"
    return Outcome(mutant.id, round, Verdict.ERROR, message=message, engine=engine)


def _with_recordings(campaign: Campaign, run: Run) -> Outcome:
    outcome = judge(campaign, run)
    if campaign.evidence is None or outcome.verdict not in _RECORDED:
        return outcome
    nondeterministic = campaign.baseline.nondeterministic
    ends = [end for end in run.ends if (run.round, end.test) not in nondeterministic]
    survived = outcome.verdict is Verdict.SURVIVED
    found = campaign.evidence.take(run.mutant.id, run.round, ends, survived=survived)[:_MOST_DIVERGED]
    is_elsewhere = any(divergence.apart for divergence in found)
    same = False if is_elsewhere and outcome.indistinguishable else outcome.indistinguishable
    return replace(outcome, diverged=found, indistinguishable=same)


def judge(campaign: Campaign, run: Run) -> Outcome:
    """Return the outcome of a run."""
    request, baseline = campaign.request, campaign.baseline
    verdict, end, message = _ruling(run, baseline.exits[run.round])
    missing = baseline.missing_judges(run.round, run.mutant) if verdict is Verdict.SURVIVED else {}
    if missing:
        verdict = Verdict.UNSTABLE
        message = f"all reliable tests passed; {_might_have_failed(missing)}"
    simulated = [end.simulated for end in run.ends if end.simulated is not None]
    by = end.by if end is not None else By.EXCEPTION if run.death is not None else By.CHECK
    acted = sum(end.acted for end in run.ends)
    at_work = (
        run.has_acted and not acted if run.death is None else run.death.acted or run.death.in_mutated_call
    )
    stopped_at_work = end is None and at_work
    outcome = Outcome(
        mutant=run.mutant.id,
        round=run.round,
        verdict=verdict,
        by=by if verdict is Verdict.KILLED else None,
        test=end.test if end is not None else run.death.test if run.death is not None else None,
        exception=end.exception if end is not None else None,
        message=message,
        place=end.place if end is not None else None,
        # a test that never ended cannot say how often, but that the mutant was at work is known
        hits=sum(end.hits for end in run.ends) + stopped_at_work,
        acted=acted + stopped_at_work,
        away=added(end.away for end in run.ends),
        example=next((end.example for end in run.ends if end.example is not None), None),
        tests=len(run.ends),
        wall=run.wall,
        cpu=sum(end.cpu for end in run.ends),
        simulated=sum(simulated) if simulated else None,
        shared=run.shared,
        engine=run.engine,
        complete=request.every_test and {end.test for end in run.ends} == set(run.tests),
        kills=_kills(run, message)[: None if request.every_test else 1] if verdict.is_killed else (),
        commands=end.commands if end is not None else None,
        looked=_looked(run, baseline) if verdict is Verdict.SURVIVED else (),
        executed=_executed(run, end, baseline, is_of_suite=end is None and verdict.is_killed),
    )
    is_short = not baseline.is_of_tests(run.mutant) and _lacks_tests(run, outcome)
    outcome = replace(outcome, confirmed=False if is_short else None)
    return _compared(campaign, outcome, run) if verdict is Verdict.SURVIVED else outcome


def _executed(run: Run, decided: TestEnd | None, baseline: Baseline, *, is_of_suite: bool) -> Executed | None:
    """Return the units executed in the tests that the outcome depends on, also by the original.

    None if that is not known: of a process that died, and of a suite that ended otherwise without a failed
    test.
    """
    if run.death is not None or run.problem is not None or is_of_suite or run.gone:
        return None
    reaching = set(baseline.tests_reaching(run.round, run.mutant))
    asked = [n for n, end in enumerate(run.ends) if end is decided or end.hits or end.test in reaching]
    # these report only what none before them has reported
    whole = max((n for n in asked if run.ends[n].hits or run.ends[n].outcome == "failed"), default=-1)
    ends = [*run.ends[: whole + 1], *(run.ends[n] for n in asked if n > whole)]
    original = baseline.executed[run.round].by(run.ends[n].test for n in asked)
    return together([*(end.executed for end in ends), original])


def _lacks_tests(run: Run, outcome: Outcome) -> bool:
    """Return whether tests that might have decided were left out before the deciding one.

    What changes nothing is the original in these as well; a refusal leaves it to other tests to decide.
    """
    if not run.left_out or outcome.verdict is Verdict.NO_EFFECT:
        return False
    is_decided = outcome.test in run.tests and outcome.verdict is not Verdict.REFUSED
    before = run.tests[: run.tests.index(outcome.test)] if is_decided else run.tests
    return not run.left_out.intersection(before) <= {end.test for end in run.ends}


def _looked(run: Run, baseline: Baseline) -> tuple[Looked, ...]:
    """Return the tests that reach a survivor, first those in which it acted."""
    reaching = set(baseline.tests_reaching(run.round, run.mutant))
    ends = (end for end in run.ends if end.test in reaching)
    found = [Looked(end.test, end.acted > 0, end.checks, end.more_checks) for end in ends]
    return tuple(sorted(found, key=lambda test: not test.acted)[:_MOST_LOOKED])


def _ruling(run: Run, usual: int) -> Ruling:
    """Return the verdict, the deciding test and the reason; ``usual`` is the suite's normal exit code."""
    if run.problem is not None:
        return Verdict.ERROR, None, run.problem
    acted = False
    refused: TestEnd | None = None
    for end in _before_death(run):
        acted = acted or end.acted > 0
        if end.failure is not None:
            return Verdict.ERROR, end, end.failure
        if end.guarded is not None:
            return (Verdict.GUARDED if acted else Verdict.UNSTABLE), end, end.guarded
        if end.invalid:
            return Verdict.INVALID, end, end.message
        if end.timeout is not None:
            return (Verdict.TIMEOUT if acted else Verdict.UNSTABLE), end, end.timeout
        if end.refused is not None and not end.caught:
            refused = refused or end
        elif end.outcome == "failed":
            if acted:
                return Verdict.KILLED, end, end.message
            return Verdict.UNSTABLE, end, f"failed before the mutant changed anything: {end.message}"
    return _ruling_on_end(run, refused, usual, acted=acted)


def _ruling_on_end(run: Run, refused: TestEnd | None, usual: int, *, acted: bool) -> Ruling:
    """Return the verdict by the end of the process, if no test decided."""
    acted = acted or run.has_acted
    if run.death is not None:
        return _ruling_on_death(run.death, acted)
    if refused is not None:
        return Verdict.REFUSED, refused, refused.refused
    if run.exit_code not in (None, usual) and not any(end.outcome == "failed" for end in run.ends):
        return _ruling_on_exit(run.exit_code, usual, acted)
    if acted:
        return Verdict.SURVIVED, None, None
    if any(end.hits for end in run.ends):
        return Verdict.NO_EFFECT, None, "the site was reached, but no value changed"
    if not provider(run.mutant.provider).knows_reach:
        return Verdict.NOT_COVERED, None, _NOT_REACHED
    return Verdict.UNSTABLE, None, "the site was reached in the baseline, but not now"


def _before_death(run: Run) -> list[TestEnd]:
    """Return the tests up to the one in which the process died, if it did; later ones decide nothing."""
    if run.death is None or run.death.test not in run.tests:
        return run.ends
    before = set(run.tests[: run.tests.index(run.death.test)])
    return [end for end in run.ends if end.test in before]


def _kills(run: Run, message: str | None) -> tuple[Kill, ...]:
    """Return the tests that noticed the mutant, in order; a crash is noticed by the test it ended."""
    found: list[Kill] = []
    acted = False
    for end in run.ends:
        acted = acted or end.acted > 0
        if acted and end.notices:
            found.append(Kill(end.test, end.by or By.EXCEPTION, end.exception, end.timeout or end.message))
    death = run.death
    if death is not None and death.test is not None and _ruling_on_death(death, acted)[0].is_killed:
        found.append(Kill(death.test, By.EXCEPTION, None, message))
    order = {test: number for number, test in enumerate(run.tests)}
    return tuple(sorted(found, key=lambda kill: order.get(kill.test, -1)))


def _ruling_on_death(death: Death, acted: bool) -> Ruling:
    if death.is_starved:
        return Verdict.UNSTABLE, None, f"{death.text}, of which it had too little: {death.hindered}"
    if death.overdue and (acted or death.acted):
        return Verdict.TIMEOUT, None, death.text
    if death.in_mutated_call and death.signal in OWN_FAULT:
        return Verdict.KILLED, None, f"the mutated call crashed: {death.text}"
    return Verdict.ERROR, None, death.text


def _ruling_on_exit(code: int | None, usual: int, acted: bool) -> Ruling:
    """Return the verdict if the suite's exit status differs though no test failed, as hooks can cause.

    Where mutabot's own hooks failed, that counts as a death.
    """
    text = f"the suite ends with exit code {code} instead of {usual}"
    if not acted:
        return Verdict.UNSTABLE, None, f"{text}, and the mutant has changed nothing"
    return Verdict.KILLED, None, text


def _collected_otherwise(run: Run) -> tuple[str, ...]:
    """Describe how the collected tests differ from the original's."""
    new = [end.test for end in run.ends if end.test not in run.tests]
    differences = [f"{in_short(run.gone, 1)} not collected"] if run.gone else []
    differences += [f"collected beside the original's tests: {in_short(new, 1)}"] if new else []
    return tuple(differences)


def _with_tests(comparisons: Mapping[str, Difference]) -> Mapping[str, Difference]:
    """Return what differs in each test; if that is several, each line names its test."""
    if sum(bool(comparison.divergence) for comparison in comparisons.values()) < 2:
        return comparisons
    return {
        test: replace(
            difference,
            divergence=tuple(f"{line} (in {test.rpartition('::')[2]})" for line in difference.divergence),
        )
        for test, difference in comparisons.items()
    }


def stable_first(comparisons: Mapping[str, Difference], scattering: Collection[str]) -> Difference:
    """Merge the comparisons of all tests; tests whose end varies in the original come last."""
    whole = farthest([*comparisons.values()])
    stable = farthest([difference for test, difference in comparisons.items() if test not in scattering])
    if not scattering or not stable.divergence:
        return whole
    others = tuple(line for line in whole.divergence if line not in stable.divergence)
    distance = whole.distance if stable.distance is None else stable.distance
    return replace(whole, distance=distance, way=stable.way, divergence=(*stable.divergence, *others))


def _compared(campaign: Campaign, outcome: Outcome, run: Run) -> Outcome:
    """Return the outcome of a survivor with how far its world is from the original's."""
    baseline, vocabulary = campaign.baseline, campaign.request.vocabulary
    if otherwise := _collected_otherwise(run):
        return replace(outcome, divergence=otherwise, indistinguishable=False)
    comparisons: dict[str, Difference] = {}
    first = next((number for number, end in enumerate(run.ends) if end.hits), 0)
    since_hit = {end.test for end in run.ends[first:]}  # before it is hit, a mutant is the original
    hit = {end.test for end in run.ends if end.hits}
    for test, found in run.observations.items():
        key = (run.round, test)
        if test not in since_hit:
            continue
        if key in baseline.nondeterministic:
            return replace(outcome, gaps=(f"equal runs of the original differ in {test}",))
        if key in baseline.observations:
            spread = baseline.probe_spread(*key, vocabulary.probes)
            known = vocabulary.probes, vocabulary.operations
            difference = compare(baseline.observations[key], found, *known, spread)
            # a test that has nothing to do with the mutant need not make what a probe reads
            comparisons[test] = difference if test in hit else replace(difference, gaps=())
    scattering = campaign.evidence.scattering(comparisons) if campaign.evidence is not None else set()
    worst = stable_first(_with_tests(comparisons), scattering)
    # Without a probe, equal traces say only that the program did the same, not that the world ended so.
    is_claimed = worst.divergence or (worst.distance is not None and not worst.gaps)
    return replace(outcome, **shallow(worst if is_claimed else replace(worst, indistinguishable=None)))
