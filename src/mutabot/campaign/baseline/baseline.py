"""The baseline: the suite on the unmutated program, twice per round, recorded.

It tells which tests reach which site with which values, how long they take, and whether they can be
relied on. What differs between the two runs of a round is flaky, and is set aside before any mutant runs.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.border.job import Budget
from mutabot.border.lines import Line, Remark, SiteSeen, TestEnd
from mutabot.campaign.comparing.observation import Event, Observation, as_steady
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.workers.said import ABNORMAL, last_line, said_in
from mutabot.campaign.workers.workers import Result, Task, Workers
from mutabot.errors import BaselineError, NothingToDoError
from mutabot.families import FAMILIES
from mutabot.model import Instrumentation, Mutant, ProgramText, Vocabulary
from mutabot.operators import load_all
from mutabot.vocabulary import problem_error

from .answers import Answers
from .failing import refuse_failing, rounds_to_repeat, why_set_aside
from .moments import moments_in, note_moments, strides_of
from .places import Place
from .program_text import ProgramTexts, read_texts
from .readability import note_readability, refuse_unreadable
from .sharing import Sharing
from .sharing import remarks as sharing_remarks
from .site_names import Sources

REPETITIONS = 2
#: operations and simulated seconds that a test may use beyond its multiple of the baseline
SPARE_OPERATIONS, SPARE_SIMULATED = 200, 10.0


@dataclass(frozen=True, slots=True)
class _Run:
    """Which run of the suite: the key of its task."""

    round: int
    repetition: int


@dataclass(frozen=True, slots=True)
class Hit:
    """One recorded call: the values it wrote and read."""

    written: Mapping[str, Any]
    read: Mapping[str, Any]


@dataclass(slots=True)
class Baseline:
    """What is known about the original.

    Attributes:
        tests: per round, the tests that ended alike in all repetitions and let the suite pass, in its order.
            A test that was skipped or failed as expected belongs to them: a mutant can make it fail.
        ends: the report of each (round, test), from the first repetition.
        hits: recorded calls by place, in the order in which places were first reached.
        answers: what these calls returned.
        reaching: (round, place) to the tests that reach it, fastest first.
        observations: (round, test) to what is compared with a mutant's.
        unstable: tests set aside as flaky, with the reason, by (round, test).
        flaky_reaching: (round, place) to the tests that reach it but are set aside in this round.
        dependent: selections of tests that pass only together with others; filled in by the controls.
        strides: after every how many commands probes are read along the way, by (round, test).
        restless: (round, test) whose trace or probes differ between repetitions; never compared.
        doubted: tests that have failed once where equal runs pass.
        unequal: (round, test) that were not the same to the last bit in all runs of the original.
        skipped: number of tests that skipped themselves.
        startup: seconds from a worker's start to the end, less the tests; the longest.
        program: the program text, if a family of mutants needs it.
        remarks: what is to be known about the vocabulary.
        sharing: per round, what its tests share.
        early: places that are reached before any test begins, while the program or a test file is imported:
            a mutant there needs a process of its own.
        widened: mutants, by id and round, that left something behind in a test which leaves nothing behind
            in the original: judged by the whole suite.
    """

    tests: list[list[str]] = field(default_factory=list)
    ends: dict[tuple[int, str], TestEnd] = field(default_factory=dict)
    hits: dict[Place, list[Hit]] = field(default_factory=dict)
    answers: dict[Place, Answers] = field(default_factory=dict)
    reaching: dict[tuple[int, Place], list[str]] = field(default_factory=dict)
    observations: dict[tuple[int, str], Observation] = field(default_factory=dict)
    unstable: dict[tuple[int, str], str] = field(default_factory=dict)
    strides: Mapping[tuple[int, str], int] = field(default_factory=dict)
    restless: set[tuple[int, str]] = field(default_factory=set)
    unequal: set[tuple[int, str]] = field(default_factory=set)
    doubted: set[str] = field(default_factory=set)
    flaky_reaching: dict[tuple[int, Place], list[str]] = field(default_factory=dict)
    dependent: set[tuple[str, ...]] = field(default_factory=set)
    skipped: int = 0
    startup: float = 0.0
    program: ProgramTexts = field(default_factory=ProgramTexts)
    remarks: tuple[Remark, ...] = ()
    sharing: list[Sharing] = field(default_factory=list)
    widened: set[tuple[str, int]] = field(default_factory=set)
    early: set[Place] = field(default_factory=set)

    @property
    def places(self) -> list[Place]:
        """All places that any test reaches in any round."""
        return list(self.hits)

    def selection(self, round: int, place: Place) -> tuple[str, ...]:
        """The tests that judge a mutant at this place, in the order in which to run them.

        Those that reach it, quickest first. Where these do not pass alone, the whole suite in its own order;
        where they share anything with others, these as well, in the same order.
        """
        return self._together(round, tuple(self.reaching.get((round, place), ())))

    def judges(self, round: int, mutant: Mutant) -> tuple[str, ...]:
        """The tests that judge a mutant: those that reach all it consists of, and what goes with them."""
        tests = self._reaching_all(round, mutant)
        if tests and (mutant.id, round) in self.widened:
            return tuple(self.tests[round])
        selections = [self.selection(round, Place.of(single)) for single in mutant.singles]
        if tests and len(selections) > 1 and tuple(self.tests[round]) in selections:
            return tuple(self.tests[round])
        return self._together(round, tests)

    def _reaching_all(self, round: int, mutant: Mutant) -> tuple[str, ...]:
        first, *others = (self.reaching.get((round, Place.of(single)), ()) for single in mutant.singles)
        return tuple(test for test in first if all(test in other for other in others))

    def _together(self, round: int, tests: tuple[str, ...]) -> tuple[str, ...]:
        if tests in self.dependent:
            return tuple(self.tests[round])
        if not tests or self.sharing[round].why_together(tests) is None:
            return tests
        together = set(self.sharing[round].closure(tests))
        return tuple(test for test in self.tests[round] if test in together)

    def why_not_branch(self, round: int, tests: Collection[str]) -> tuple[str, str] | None:
        """One of these tests that forbids to fork for a mutant that they judge, and why; else None."""
        return self.sharing[round].why_together(tests) or self.sharing[round].why_alone(tests)

    def is_early(self, mutant: Mutant) -> bool:
        """Whether a mutant may act before any test begins."""
        return self.program.is_early(mutant) or any(Place.of(one) in self.early for one in mutant.singles)

    def in_order(self, round: int, tests: Collection[str]) -> tuple[str, ...]:
        """These tests as one process may run them: quickest first, unless they share anything."""
        is_shared = self.sharing[round].why_together(tests) is not None
        order = self.tests[round] if is_shared else self.by_cost(round)
        return tuple(test for test in order if test in tests)

    def must_widen(self, mutant: Mutant, round: int, ends: Iterable[TestEnd]) -> bool:
        """Whether tests that do not reach a mutant might notice what it left behind in those that do.

        From then on the whole suite judges it in this round.
        """
        whole = set(self.tests[round]) <= {end.test for end in ends}
        left = any(self._left_behind(round, end) for end in ends)
        if left and not whole:
            self.widened.add((mutant.id, round))
        return left and not whole

    def _left_behind(self, round: int, end: TestEnd) -> bool:
        """Whether a test left something behind that it leaves as it was in the original."""
        if end.footprint is None or end.test in self.sharing[round].reasons:
            return False
        original = self.ends[round, end.test].footprint
        return not set(end.footprint.left) <= set(original.left if original is not None else ())

    def judge_by_whole_suite(self, round: int, test: str) -> None:
        """A test passes only after others: no selection with it can be relied on by itself."""
        for (where, _), tests in self.reaching.items():
            if where == round and test in tests:
                self.dependent.add(tuple(tests))

    def compare_runs(self, round: int, end: TestEnd, found: Observation, vocabulary: Vocabulary) -> None:
        """Compare one more run of a test of the original with its first."""
        key = (round, end.test)
        first = self.observations[key]
        if found == first and end.simulated == self.ends[key].simulated:
            return
        # the first run of all is not read along the way, so nothing differs there
        comparable = found if first.moments else replace(found, moments=first.moments)
        if comparable != first or end.simulated != self.ends[key].simulated:
            self.unequal.add(key)
        self.observe_again(round, end.test, found, vocabulary)

    def set_aside(self, round: int, test: str, reason: str) -> None:
        """A test turned out to be flaky: from now on no mutant is judged by it in this round."""
        self.unstable[round, test] = reason
        self.tests[round] = [other for other in self.tests[round] if other != test]
        for (where, place), tests in self.reaching.items():
            if where == round and test in tests:
                tests.remove(test)
                self.flaky_reaching.setdefault((where, place), []).append(test)

    def ran(self, round: int) -> list[str]:
        """The tests of a round that were not skipped."""
        return [test for test in self.tests[round] if self.ends[round, test].outcome != "skipped"]

    def missing_judges(self, round: int, mutant: Mutant) -> list[str]:
        """Tests that would judge a mutant, were they not set aside in this round.

        A test that fails may stop short of a place that it reaches in other rounds.
        """
        aside = [test for where, test in self.unstable if where == round]
        return [test for test in aside if all(self._reaches(test, single) for single in mutant.singles)]

    def _reaches(self, test: str, single: Mutant) -> bool:
        place = Place.of(single)
        return any(
            test in found.get((other, place), ())
            for other in range(len(self.tests))
            for found in (self.reaching, self.flaky_reaching)
        )

    def observe_again(self, round: int, test: str, found: Observation, vocabulary: Vocabulary) -> None:
        """An equal run of the original: only what both have alike can be compared with a mutant's."""
        known = (vocabulary.probes, vocabulary.operations)
        steady = as_steady(self.observations[round, test], found, *known)
        if steady is None:
            self.restless.add((round, test))
        else:
            self.observations[round, test] = steady

    def by_cost(self, round: int) -> list[str]:
        """All tests of a round, quickest first: the order of every selection."""
        return sorted(self.tests[round], key=lambda test: _cost(self.ends[round, test]))

    def budget(self, round: int, test: str, factor: float) -> Budget:
        """What a mutant may use in this test."""
        end = self.ends[round, test]
        return Budget(
            operations=int(end.operations * factor) + SPARE_OPERATIONS,
            simulated=None if end.simulated is None else end.simulated * factor + SPARE_SIMULATED,
        )


def take_baseline(
    request: Request,
    workers: Workers,
    progress: Progress,
    *,
    repetitions: int = REPETITIONS,
    may_share: bool = False,
) -> tuple[Baseline, list[Result]]:
    """Run the suite on the original and look at what it does.

    With one repetition the second run is left to the trunks of the branch engine. ``may_share``: whether
    imports and collection may be done once for all runs.

    Returns the baseline and the raw results, first repetitions first.

    Raises ConfigurationError for a vocabulary that does not fit the program, NothingToDoError without
    tests, BaselineError when tests fail.
    """
    texts, refused = read_texts(request.root, request.configuration.program, request.families)
    for file, why in refused.items():
        progress.note(f"no mutants of the text of {file}: {why}")
    for family in dict.fromkeys(rule.family for rule in load_all()):  # a broken plug-in is told now
        if family not in (*request.families, *FAMILIES):
            progress.note(f"operators of family {family!r} are not asked for: add --family {family}")
    progress.stage("baseline", request.rounds * repetitions)
    results: dict[tuple[int, int], Result] = {}
    remarks: list[Remark] = []

    def run_suite(tasks: Iterable[Task]) -> None:
        for result in _told_as_they_come(workers.events(tasks), progress, remarks):
            run: _Run = result.task.key
            results[run.round, run.repetition] = result
            _refuse(result, request.arguments)
            progress.advance(f"baseline, round {run.round + 1}, run {run.repetition + 1}: {_counts(result)}")

    run_suite(_tasks(request, texts, may_share))
    strides = strides_of({(run[0], end.test): end for run, result in results.items() for end in result.ends})
    if repetitions > 1:
        run_suite(_again(request, repetitions, strides, may_share))
    if repetitions == 1:  # was it chance, or the round's seed?
        again = rounds_to_repeat({run[0]: result.ends for run, result in results.items()})
        run_suite(
            Task(_Run(round, 1), request.job(round, record=True), startup=300.0, may_share=may_share)
            for round in again
        )
    baseline = Baseline(strides=strides, remarks=tuple(dict.fromkeys(remarks)))
    sources = Sources(request.root)
    failing: dict[tuple[int, str], TestEnd] = {}
    for round in range(request.rounds):
        runs = [results[key] for key in sorted(results) if key[0] == round]
        failing |= _add_round(baseline, request, sources, round, runs)
    refuse_failing(request, failing)
    if texts:
        first = {round: results[round, 0] for round in range(request.rounds)}
        baseline.program = ProgramTexts.of(texts, first, request.families)
        _add_text_places(baseline)
    if not any(baseline.ran(round) for round in range(request.rounds)):
        raise NothingToDoError(_no_tests(baseline))
    refuse_unreadable(request.vocabulary, list(baseline.ends.values()))
    note_readability(request.vocabulary, list(baseline.ends.values()), progress)
    for remark in sharing_remarks(baseline.sharing, _not_private(results.values())):
        progress.note(remark)
    note_moments(baseline.ends.values(), progress)
    return baseline, [results[key] for key in sorted(results, key=lambda key: (key[1], key[0]))]


def _not_private(results: Iterable[Result]) -> str | None:
    """Why a run could not keep its files to itself."""
    return next((one.end.not_private for one in results if one.end and one.end.not_private), None)


def _told_as_they_come(
    events: Iterator[Result | tuple[Task, Line]], progress: Progress, remarks: list[Remark]
) -> Iterator[Result]:
    """Results; remarks are told when they are made, which is before the tests run where that is possible."""
    for event in events:
        if isinstance(event, Result):
            yield event
        elif isinstance(event[1], Remark):
            remarks.append(event[1])
            progress.note(str(event[1]))


def _tasks(request: Request, texts: tuple[ProgramText, ...], may_share: bool) -> Iterator[Task]:
    """The first run of each round."""
    recording = Instrumentation(texts, record=True) if texts else None
    for round in range(request.rounds):
        job = request.job(round, record=True, inspect=round == 0, instrumentation=recording)
        yield Task(_Run(round, 0), job, startup=300.0, may_share=may_share)


def _again(
    request: Request, repetitions: int, strides: Mapping[tuple[int, str], int], may_share: bool
) -> Iterator[Task]:
    """Further runs, of the text as it stands: neither looking at it nor probes may change anything."""
    for repetition in range(1, repetitions):
        for round in range(request.rounds):
            job = request.job(round, record=True, moments=moments_in(strides, round))
            yield Task(_Run(round, repetition), job, startup=300.0, may_share=may_share)


def _refuse(result: Result, arguments: Sequence[str]) -> None:
    """Stop at once if this run of the suite cannot be a baseline."""
    if result.problems:
        raise _worst_problem(result)
    if result.end is None:
        text = f"the tests cannot be run on the original: {death(result, said=False)}{at(result)}"
        raise BaselineError(f"{text}{said_in(result.log)}", tests=_running(result))
    if result.end.errors:
        raise BaselineError("the tests cannot be collected:\n" + "\n".join(result.end.errors))
    how = ABNORMAL.get(result.end.exit_status)
    if how is not None:
        text = f"pytest ended with exit status {result.end.exit_status} ({how})"
        raise BaselineError(f"the tests cannot be run on the original: {text}{said_in(result.log)}")
    if not result.end.collected:
        raise NothingToDoError(f"pytest finds no tests with {' '.join(arguments)}{said_in(result.log)}")
    broken = [end for end in result.ends if end.failure is not None and end.outcome == "failed"]
    if broken:
        raise BaselineError(
            f"{broken[0].test}: {broken[0].failure}; the original must run before mutants can",
            tests=[end.test for end in broken],
        )


def _worst_problem(result: Result) -> Exception:
    errors = [problem_error(problem) for problem in result.problems]
    if len(errors) > 1:
        errors[0].args = ("\n".join(str(error) for error in errors[:10]),)
    return errors[0]


def _running(result: Result) -> list[str]:
    return [result.running] if result.running is not None else []


def death(result: Result, *, said: bool = True) -> str:
    """How a worker ended that did not end in an orderly way, and the last that it ``said``."""
    during = f" during {result.running}" if result.running else ""
    if result.overdue:
        return f"{result.overdue}{during}"
    code = result.exit_code
    how = f"killed by signal {-code}" if code < 0 else f"the process ended with exit code {code}"
    line = last_line(result.log) if said else ""
    return f"{how}{during}{f'; it said last: {line}' if line else ''}"


def at(result: Result) -> str:
    """Where a worker was when its time was up, to be added to how it ended; empty if that is not known."""
    return f"; it was at {result.where}" if result.where is not None else ""


def _counts(result: Result) -> str:
    counts: dict[str, int] = {}
    for end in result.ends:
        counts[end.outcome] = counts.get(end.outcome, 0) + 1
    return ", ".join(f"{count} {outcome}" for outcome, count in counts.items()) or "nothing ran"


def _add_round(
    baseline: Baseline, request: Request, sources: Sources, round: int, repetitions: list[Result]
) -> dict[tuple[int, str], TestEnd]:
    """Take in the runs of a round; returns the tests that fail in all of them."""
    runs = [{end.test: end for end in result.ends} for result in repetitions]
    observed = [_observations(result, sources) for result in repetitions]
    failed: dict[tuple[int, str], TestEnd] = {}
    good: list[str] = []
    for test, end in runs[0].items():
        others = [run.get(test) for run in runs[1:]]
        outcomes = {other.lasting if other is not None else "missing" for other in [end, *others]}
        if outcomes == {"failed"}:
            failed[round, test] = end
            baseline.unstable[round, test] = why_set_aside(request, round, end)
        elif len(outcomes) > 1:
            baseline.unstable[round, test] = f"{' and '.join(sorted(outcomes))} in equal runs"
        elif end.failure is not None:  # it says that the simulator will fail in it, so it judges nothing
            baseline.skipped += 1
        else:
            baseline.skipped += end.outcome == "skipped"
            good.append(test)
            baseline.ends[round, test] = replace(end, wall=max([end.wall, *(o.wall for o in others if o)]))
            baseline.observations[round, test] = observed[0][test]
            for again, found in zip(others, observed[1:], strict=True):
                if again is not None:
                    baseline.compare_runs(round, again, found[test], request.vocabulary)
    baseline.tests.append(good)
    spent = (result.wall - sum(end.wall for end in result.ends) for result in repetitions)
    baseline.startup = max([baseline.startup, *spent])
    baseline.sharing.append(Sharing.of([(end.test, end.footprint) for end in repetitions[0].ends]))
    _add_hits(baseline, sources, round, repetitions[0], good)
    return failed


def _no_tests(baseline: Baseline) -> str:
    if baseline.unstable:
        test, reason = next((key[1], reason) for key, reason in baseline.unstable.items())
        return f"no test can be relied on: all are flaky, such as {test} ({reason})"
    return f"no test ran: {baseline.skipped} skipped"


def _add_hits(baseline: Baseline, sources: Sources, round: int, result: Result, good: list[str]) -> None:
    places = places_of(result, sources)
    reaching: dict[Place, list[str]] = {}
    for end in result.ends:
        if end.test not in good:
            _add_set_aside(baseline, round, end.test, {places[index] for index, *_ in end.trace})
            continue
        for index, written, read, answer in end.trace:
            place = places[index]
            baseline.hits.setdefault(place, []).append(Hit(written, read))
            baseline.answers.setdefault(place, Answers()).add(round, end.test, answer)
            tests = reaching.setdefault(place, [])
            if end.test not in tests:
                tests.append(end.test)
    for index, written, read, answer in result.called_at_import:
        place = places[index]
        baseline.hits.setdefault(place, []).append(Hit(written, read))
        baseline.answers.setdefault(place, Answers()).add(round, "", answer)
        baseline.early.add(place)
        reaching[place] = list(good)
    for place, tests in reaching.items():
        baseline.reaching[round, place] = sorted(tests, key=lambda test: _cost(baseline.ends[round, test]))


def _add_set_aside(baseline: Baseline, round: int, test: str, places: Iterable[Place]) -> None:
    """Where a test that is set aside would have judged mutants."""
    for place in places if (round, test) in baseline.unstable else ():
        baseline.flaky_reaching.setdefault((round, place), []).append(test)


def _add_text_places(baseline: Baseline) -> None:
    """Which tests reach which place; what is evaluated before the tests, or at import, is there for all."""
    for (round, place), reached in baseline.program.reached.items():
        aside = [test for where, test in baseline.unstable if where == round]
        if place in baseline.program.early:
            baseline.reaching[round, place] = baseline.by_cost(round)
        else:
            tests = set(reached)
            aside = [test for test in aside if test in tests]
            baseline.reaching[round, place] = [test for test in baseline.by_cost(round) if test in tests]
        for test in aside:
            _add_set_aside(baseline, round, test, [place])


def _cost(end: TestEnd) -> tuple[float, int]:
    """What a test costs, in a measure that is the same in every run: wall clocks are not."""
    return (end.simulated or 0.0, end.operations)


def places_of(result: Result, sources: Sources) -> dict[int, Place]:
    """The places a worker reported, by their index in its traces."""
    return {seen.index: place_of(seen, sources) for seen in result.sites}


def place_of(seen: SiteSeen, sources: Sources) -> Place:
    """The place at which something was seen."""
    return Place(sources.site(seen), seen.operation, seen.pattern)


def _observations(result: Result, sources: Sources) -> dict[str, Observation]:
    places = places_of(result, sources)
    return {end.test: observation(end, places) for end in result.ends}


def observation(end: TestEnd, places: Mapping[int, Place]) -> Observation:
    """What is compared of a test."""
    events = []
    for index, written, read, _ in end.trace:
        place = places[index]
        events.append(Event(place.key, written, read, (place.operation, place.pattern)))
    prepared, called = end.returned[: end.prepared], end.returned[end.prepared :]
    return Observation(
        events, end.probes, end.truncated, end.unread, end.outcome, prepared, called, end.moments
    )
