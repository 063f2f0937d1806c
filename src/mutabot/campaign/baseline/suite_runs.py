"""Take the baseline: run the suite on the original, and read its events.

Tests that fail on the original are an error if they do in every round, and are set aside where they do so in
some. Each is named with its seed and with the command that makes plain pytest draw the seeds of that round.
"""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Protocol

from mutabot.campaign.baseline.remarks import lines_of
from mutabot.campaign.baseline.writes import written_through
from mutabot.campaign.probe_readings import probe_intervals_of
from mutabot.campaign.request import Progress, Request
from mutabot.config.mistakes import problem_error
from mutabot.errors import BaselineError, NothingToDoError, in_short, plural
from mutabot.execution.task import ABNORMAL, Result, Task, tail_of
from mutabot.families import OF_CALLS
from mutabot.languages.read_parts import read_parts
from mutabot.languages.registry import program_files
from mutabot.model import Instrumentation, Span
from mutabot.model.call import CAMPAIGN_SEED_VARIABLE, DEFAULT_SEED, ROUND_VARIABLE, derive
from mutabot.model.deadline import Limit
from mutabot.model.events import Event, Remark, TestEnd
from mutabot.model.outcome_text import first_line
from mutabot.model.source_units import ExecutedByTests
from mutabot.operators import load_all
from mutabot.original import Hit, RecordedAnswers, TextSeen

from .baseline import Baseline, Sources, observation, refusals_by_test
from .out_of_reach import files_out_of_reach, with_texts
from .untested import add_untested

if TYPE_CHECKING:
    from mutabot.model.mutant import Place
    from mutabot.model.program_text import ProgramText

#: how the reason begins why such a test is set aside: its seed makes it fail, not chance
FAILS = "fails on the unmutated program"
#: the tests that fail in all runs of a round, by (round, test)
Failing = Mapping[tuple[int, str], TestEnd]


def rounds_to_repeat(ends: Mapping[int, Iterable[TestEnd]]) -> list[int]:
    """Return the rounds worth a second run: tests fail in them, and no test fails in all rounds.

    With a single round, that is the one if tests fail in it.
    """
    failed = {round: {end.test for end in these if end.outcome == "failed"} for round, these in ends.items()}
    if len(failed) > 1 and set.intersection(*failed.values()):
        return []
    return [round for round, tests in sorted(failed.items()) if tests]


def repeat_command(request: Request, round: int, test: str) -> str:
    """Return the shell command that runs this test with plain pytest as in this round, from the project."""
    variables = f"{ROUND_VARIABLE}={round + 1}"
    if request.seed != DEFAULT_SEED:
        variables += f" {CAMPAIGN_SEED_VARIABLE}={request.seed}"
    return f"{variables} {shlex.join(['pytest', *request.configuration.pytest_args, test])}"


def why_set_aside(request: Request, round: int, end: TestEnd) -> str:
    """Return why a test that fails on the original is excluded from this round."""
    seed = derive(request.seed, round, end.test)
    text = f"{FAILS} with seed {seed}: {first_line(end.message)}"
    return f"{text}; repeat it by {repeat_command(request, round, end.test)}"


def refuse_failing(request: Request, failing: Failing) -> None:
    """Raise BaselineError if a test fails in all rounds."""
    rounds = range(request.rounds)
    always = [end for (_, test), end in failing.items() if all((round, test) in failing for round in rounds)]
    found = list({end.test: end for end in reversed(always)}.values())[::-1]
    if not found:
        return
    where = "in round 1" if request.rounds == 1 else f"in all {request.rounds} rounds"
    shown = "\n".join(f"  {end.test}: {first_line(end.message)}" for end in found[:10])
    more = f"\n  … and {len(found) - 10} more" if len(found) > 10 else ""
    noun = "test fails" if len(found) == 1 else "tests fail"
    again = (
        f"\nrepeat by {repeat_command(request, 0, found[0].test)}"
        f"\nand repair it, or leave it out: pytest_args = {['--deselect', found[0].test]!r}"
    )
    raise BaselineError(f"{len(found)} {noun} on the unmutated program {where}:\n{shown}{more}{again}")


_KNOWN_LATER = (
    "at {} some tests call an operation and others what may be another function: it counts as the "
    "operation there, and the tests are recorded again"
)
_NOT_IN_COPIES = (
    "tests fail in copies of a process that has imported and collected them, and not in fresh ones: each "
    "run of the original begins in a process of its own"
)
_NOT_LOOKED_AT = "tests fail while mutabot looks which values its text has"
#: pytest's exit code where tests failed
_FAILED = 1


class Runs(Protocol):
    """A source of runs of the original: an executor, or a store of earlier runs."""

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        """See ``Executor``."""


@dataclass(slots=True)
class _Suite:
    """The suite on the original, run as often as necessary.

    Attributes:
        results: by round and repetition.
        remarks: what is to be known about the vocabulary.
        known: see ``Job.known``.
        probe_intervals: by round and test, see ``Baseline``.
        may_share: whether runs may begin as copies of one process that has collected the tests.
    """

    request: Request
    executor: Runs
    progress: Progress
    results: dict[tuple[int, int], Result] = field(default_factory=dict)
    remarks: list[Remark] = field(default_factory=list)
    known: dict[Span, str] = field(default_factory=dict)
    probe_intervals: Mapping[int, Mapping[str, int]] = field(default_factory=dict)
    may_share: bool = True

    def run(self, tasks: Iterable[Task]) -> None:
        """Run tasks until the result of one cannot be a baseline. Raises what ``take_baseline`` raises."""
        before = len(self.remarks)
        try:
            self._run(tasks)
        finally:
            for line in lines_of(self.remarks[before:]):
                self.progress.note(line)

    def _run(self, tasks: Iterable[Task]) -> None:
        for result in self.executor.events(tasks):
            if not isinstance(result, Result):
                if isinstance(result[1], Remark):
                    self.remarks.append(result[1])
                continue
            round, repetition = result.task.key
            self.results[round, repetition] = result
            if any("::" in argument for argument in self.request.arguments):
                self._note_unread(result)
            _refuse(result, self.request.arguments)
            counts = Counter(end.outcome for end in result.ends)
            counted = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
            which = f"round {round + 1}{f', run {repetition + 1}' if repetition else ''}"
            self.progress.advance(f"{which}: {counted or 'nothing ran'}")

    def _note_unread(self, result: Result) -> None:
        """Turn problems of results that were not read into remarks, if only single tests are run."""
        unread = [remark for remark in result.problems if remark.key.startswith("result.")]
        result.problems = [remark for remark in result.problems if remark not in unread]
        for problem in unread:
            why = "no result had it: only single tests are run, and others may read it"
            self.remarks.append(Remark(problem.source, problem.key, why))

    def task(self, round: int, repetition: int, **details: Any) -> Task:
        """Return the task that runs the original in a round; forks share imports and collection."""
        job = self.request.job(round, record=True, known=tuple(self.known.items()), **details)
        return Task((round, repetition), job, startup=Limit(300.0), may_share=self.may_share)

    def failing(self) -> set[tuple[int, str]]:
        """Return the tests that fail in a run so far, each with its round."""
        ends = ((key[0], end) for key, result in self.results.items() for end in result.ends)
        return {(round, end.test) for round, end in ends if end.outcome == "failed"}

    def learns(self) -> bool:
        """Return whether the runs so far found operations at sites that were unknown in some tests."""
        for result in self.results.values():
            self.known.update(result.known_later)
        return bool(self.known)


def take_baseline(
    request: Request,
    executor: Runs,
    progress: Progress,
    *,
    texts: Mapping[str, tuple[ProgramText, ...]] | None = None,
    repetitions: int | None = None,
) -> tuple[Baseline, list[Result]]:
    """Run the suite on the original and record what it does.

    ``texts``: the program text to look at, by the providers that ask for it. ``repetitions``: how often each
    round is run; as often as the request says, if it is not given. With one, the second run is left to the
    fork parents.

    Returns the baseline and the raw results, first repetitions first.

    Raises ConfigurationError for a vocabulary that does not fit the program, NothingToDoError without
    tests, BaselineError when tests fail.
    """
    texts, repetitions = texts or {}, repetitions or request.repetitions
    _note_operators(request, progress)
    progress.stage("baseline", request.rounds * repetitions)
    suite = _Suite(request, executor, progress, may_share=request.forks)
    _run(suite, texts, repetitions)
    try:
        baseline = _read(suite, texts)
    except BaselineError:
        # a copy has another process id, parent and session than the process that has imported the tests
        suite = _Suite(request, executor, progress, may_share=False)
        if not request.forks or not _run(suite, texts, repetitions, if_all_pass=True):
            raise
        baseline = _read(suite, texts)
        progress.note(_NOT_IN_COPIES)
    results = suite.results
    return baseline, [results[key] for key in sorted(results, key=lambda key: (key[1], key[0]))]


def _run(
    suite: _Suite,
    of_providers: Mapping[str, tuple[ProgramText, ...]],
    repetitions: int,
    *,
    if_all_pass: bool = False,
) -> bool:
    """Run the suite as often as necessary; False if it ends with the first runs, since tests fail in them."""
    request = suite.request
    texts = tuple(text for found in of_providers.values() for text in found)
    recording = Instrumentation(texts, record=True) if texts else None
    suite.run(_first_runs(suite, recording))
    is_looked_at = recording is None or not _fails_if_instrumented(suite, recording)
    if if_all_pass and suite.failing():
        return False
    if suite.learns():
        suite.progress.note(_KNOWN_LATER.format(plural(len(suite.known), "site")))
        suite.remarks.clear()
        suite.progress.stage("baseline again", request.rounds * repetitions)
        suite.run(_first_runs(suite, recording if is_looked_at else None))
    if not is_looked_at:
        for result in suite.results.values():
            result.not_instrumented |= {text.file: _NOT_LOOKED_AT for text in texts}
    suite.probe_intervals = probe_intervals_of(
        {(run[0], end.test): end for run, result in suite.results.items() for end in result.ends}
    )
    if repetitions > 1:  # of the text as it stands: neither looking at it nor probes may change anything
        suite.run(
            suite.task(round, repetition, moments=suite.probe_intervals.get(round, {}))
            for repetition in range(1, repetitions)
            for round in range(request.rounds)
        )
    else:  # was it chance, or the round's seed?
        failing = rounds_to_repeat({run[0]: result.ends for run, result in suite.results.items()})
        suite.run(suite.task(round, 1) for round in failing)
    return True


def _first_runs(suite: _Suite, recording: Instrumentation | None) -> Iterator[Task]:
    for round in range(suite.request.rounds):
        yield suite.task(round, 0, inspect=round == 0, instrumentation=recording)


def _fails_if_instrumented(suite: _Suite, recording: Instrumentation) -> bool:
    """Return whether tests fail only if the program text is instrumented; if so, use runs without that."""
    first, failing = dict(suite.results), suite.failing()
    if not failing:
        return False
    suite.run(_first_runs(suite, None))
    plain, failing = dict(suite.results), failing - suite.failing()
    if failing:  # or was it chance?
        suite.run(_first_runs(suite, recording))
    is_so = bool(failing & suite.failing())
    suite.results.update(plain if is_so else first)
    return is_so


def _note_operators(request: Request, progress: Progress) -> None:
    for family in dict.fromkeys(rule.family for rule in load_all()):  # a broken plug-in is reported now
        if family not in (*request.families, *OF_CALLS):
            progress.note(f"operators of family {family!r} are not asked for: add --family {family}")


def _read(suite: _Suite, texts: Mapping[str, tuple[ProgramText, ...]]) -> Baseline:
    """Combine the results of all runs into the baseline, with notes for the user."""
    request, progress = suite.request, suite.progress
    remarks = tuple(dict.fromkeys(suite.remarks))
    known = tuple(suite.known.items())
    baseline = Baseline(
        probe_intervals=suite.probe_intervals, remarks=remarks, texts=dict(texts), known=known,
        may_share=suite.may_share,
    )  # fmt: skip
    sources = Sources(request.root)
    failing: dict[tuple[int, str], TestEnd] = {}
    for round in range(request.rounds):
        of_round = [suite.results[key] for key in sorted(suite.results) if key[0] == round]
        failing |= _add_round(baseline, request, sources, round, of_round)
        first = suite.results[round, 0]
        baseline.text[round] = TextSeen(
            imported=frozenset(first.seen.imported if first.seen else ()),
            sightings=tuple(first.seen.sightings if first.seen else ()),
            reached=first.reached,
            below=first.reached_below,
            refused=first.not_instrumented,
        )
    add_untested(
        baseline, request.root, request.configuration.program, request.vocabulary, suite.results.values()
    )
    refuse_failing(request, failing)
    if not any(baseline.ran(round) for round in range(request.rounds)):
        raise NothingToDoError(_no_tests(baseline))
    ends = list(baseline.ends.values())
    found = (baseline.why_exclusive(round) for round in range(len(baseline.tests)))
    for test, how in [reader for reader in found if reader is not None][:1]:
        progress.note(f"{test}: it {how}: mutants run one after the other, with nothing beside them")
    ended = (result.end for result in suite.results.values() if result.end is not None)
    why = next((end.not_private for end in ended if end.not_private), None)
    baseline.shares_files = why is not None or not request.configuration.private_files
    if why is not None:
        progress.note(
            f"runs cannot keep their files to themselves ({why}): each mutant runs in a process of its own, "
            "one after the other, and what one leaves, others may find. User namespaces would allow it, in a "
            "container --cap-add SYS_ADMIN --security-opt apparmor=unconfined"
        )
    _note_read_texts(baseline, request, progress)
    not_along = next((end.not_along for end in ends if end.not_along), None)
    if not_along is not None:
        progress.note(f"the probes are read at the ends of tests only, not along the way: {not_along}")
    return baseline


def _note_read_texts(baseline: Baseline, request: Request, progress: Progress) -> None:
    """Note which files of the program tests read as text, and what comes of that."""
    files = program_files(request.root, request.configuration.program)
    read = [file for file in files if baseline.is_read(file)]
    reasons = ["its mutants change the file as well, each for itself"] if baseline.texts else []
    if not {*request.families}.isdisjoint(OF_CALLS):
        reasons.append("mutants of calls act in it only where they run it unchanged")
    if read and reasons:
        readers = (baseline.readers(round, read[0]) for round in range(len(baseline.tests)))
        first = next(tests[0] for tests in readers if tests)
        progress.note(f"tests from {first} on may read {in_short(read, 2)} as text: {'; '.join(reasons)}")


def _refuse(result: Result, arguments: Sequence[str]) -> None:
    """Raise an error if this run of the suite cannot be a baseline."""
    if result.problems:
        errors = [problem_error(problem) for problem in result.problems]
        if len(errors) > 1:
            errors[0].args = ("\n".join(str(error) for error in errors[:10]),)
        raise errors[0]
    if result.untrusted is not None:
        raise BaselineError(
            f"the tests cannot be run on the original: {result.untrusted}; do they write to descriptors that "
            "they have not opened, or delete .mutabot?"
        )
    if result.end is None:
        text = f"the tests cannot be run on the original: {result.death(with_message=False)}"
        raise BaselineError(f"{text}{tail_of(result.log)}")
    if result.end.errors:
        raise BaselineError("the tests cannot be collected:\n" + "\n".join(result.end.errors))
    how = ABNORMAL.get(result.end.exit_status)
    if how is not None:
        text = f"pytest ended with exit status {result.end.exit_status} ({how})"
        raise BaselineError(f"the tests cannot be run on the original: {text}{tail_of(result.log)}")
    if not result.end.collected:
        raise NothingToDoError(f"pytest finds no tests with {' '.join(arguments)}{tail_of(result.log)}")
    kept = next((end for end in result.ends if end.guarded is not None), None)
    if kept is not None:
        raise BaselineError(
            f"{kept.test}: a guard keeps a command of the original program from the robot: {kept.guarded}; "
            "widen the guard if the command is right, and correct the program if it is not"
        )
    broken = [end for end in result.ends if end.failure is not None and end.outcome == "failed"]
    if broken:
        raise BaselineError(
            f"{broken[0].test}: {broken[0].failure}; the original must run before mutants can"
        )


def _add_round(
    baseline: Baseline, request: Request, sources: Sources, round: int, repetitions: list[Result]
) -> dict[tuple[int, str], TestEnd]:
    """Add the runs of a round to the baseline. Return the tests that fail in all of them."""
    runs = [{end.test: end for end in result.ends} for result in repetitions]
    places = [sources.places(result.sites) for result in repetitions]
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
            seen = [end, *(other for other in others if other is not None)]
            wall, cpu = max(seen_end.wall for seen_end in seen), max(seen_end.cpu for seen_end in seen)
            baseline.ends[round, test] = replace(end, wall=wall, cpu=cpu, recording=None, executed=None)
            baseline.observations[round, test] = observation(end, places[0])
            for again, there in zip(others, places[1:], strict=True):
                if again is not None:
                    baseline.compare_runs(round, again, observation(again, there), request.vocabulary)
    baseline.tests.append(good)
    first = repetitions[0].end
    baseline.collected[round] = frozenset(first.collected if first is not None else ())
    ends = repetitions[0].ends
    unjudged = files_out_of_reach(request.root, request.configuration.program, ends)
    baseline.out_of_reach |= {(round, test): files for test, files in unjudged.items()}
    executed = ((end.test, with_texts(end.executed, unjudged.get(end.test, ()))) for end in ends)
    baseline.executed[round] = ExecutedByTests(executed)
    spent = (result.wall - sum(end.wall for end in result.ends) for result in repetitions)
    baseline.startup = max([baseline.startup, *spent])
    # without the tests that are set aside nothing fails
    is_set_aside = len(good) < len(runs[0]) and repetitions[0].exit_code == _FAILED
    baseline.exits[round] = 0 if is_set_aside else repetitions[0].exit_code
    _add_hits(baseline, sources, round, repetitions[0], places[0])
    for result, there in zip(repetitions, places, strict=True):
        for end in result.ends:
            if (round, end.test) in baseline.unstable:  # where it would have judged mutants
                baseline.reach_in_vain(round, end.test, {there[index] for index, *_ in end.trace})
    refused = refusals_by_test(repetitions[0], places[0])
    baseline.refused |= {(round, test): calls for test, calls in refused.items()}
    return failed


def _no_tests(baseline: Baseline) -> str:
    if baseline.unstable:
        test, reason = next((key[1], reason) for key, reason in baseline.unstable.items())
        return f"no test can be relied on: all are flaky, such as {test} ({reason})"
    return f"no test ran: {baseline.skipped} skipped"


def _add_hits(
    baseline: Baseline, sources: Sources, round: int, result: Result, places: Mapping[int, Place]
) -> None:
    good = set(baseline.tests[round])
    live = {places[index] for end in result.ends for index in end.live}
    baseline.written_through |= {
        place for place in live if sources.is_among(place.site.span, written_through)
    }
    for seen in result.sites:
        place = places[seen.index]
        parts = sources.found_at(seen.span, read_parts) if seen.direct else None
        before = baseline.read_parts.get(place, frozenset())
        baseline.read_parts[place] = None if parts is None or before is None else before | parts
        if seen.stands_in:
            baseline.stand_ins.add(place)
    reaching: dict[Place, set[str]] = {}
    for end in result.ends:
        if end.test not in good:
            continue
        for origin, indexes in end.below.items():
            for place in map(places.__getitem__, indexes):
                baseline.reach_below(round, place, end.test, origin)
        for index, written, read, answer in end.trace:
            place = places[index]
            baseline.hits.setdefault(place, []).append(Hit(written, read, (round, end.test)))
            baseline.answers.setdefault(place, RecordedAnswers()).add(round, end.test, answer)
            reaching.setdefault(place, set()).add(end.test)
    for call in result.called_at_import:
        place = places[call.site]
        baseline.hits.setdefault(place, []).append(Hit(call.written, call.read, (round, "")))
        baseline.answers.setdefault(place, RecordedAnswers()).add(round, "", call.answer)
        baseline.early.add(place)
        reaching[place] = good
    for place, tests in reaching.items():
        baseline.reach(round, place, tests)
