"""The baseline: the suite on the unmutated program, twice per round, recorded.

It holds which tests reach which site with which values, how long they take, and whether they can be relied
on. What differs between the two runs of a round is flaky, and is set aside before any mutant runs. What calls
of one place returned says what a mutant that leaves them out answers.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from mutabot.campaign.comparison import Observation, ProbeSpread, TraceCall, as_steady
from mutabot.families import CALLS, CONTROL, MESSAGES
from mutabot.faults import Planned, PlannedMutant
from mutabot.journal.records import Untested
from mutabot.languages.python import FRONT_END as PYTHON
from mutabot.languages.registry import front_end_of
from mutabot.model.activation import CALL_FAULT, Activation
from mutabot.model.events import TRACE_LIMIT, Remark, SiteSeen, TestEnd
from mutabot.model.job import RefusedAt
from mutabot.model.mutant import Extent, Mutant, Place, Role, Site, Span
from mutabot.model.program_text import Instrumentation, ProgramText
from mutabot.operators.command import Identity
from mutabot.original import Original

if TYPE_CHECKING:
    from mutabot.execution.task import Result
    from mutabot.model import Probe, Vocabulary

_T = TypeVar("_T")


@dataclass(slots=True)
class PlantedFaults:
    """An index of all planned mutants: their activations, and their places in the program text.

    Attributes:
        by_id: the mutants of the first order.
        left_out_beforehand: those left out for another reason than that they would change nothing in the
            calls of the baseline.
        texts: program text with the alternatives that can run.
        providers: the provider of each place, except for places of calls.
    """

    by_id: dict[str, PlannedMutant] = field(default_factory=dict)
    left_out_beforehand: list[PlannedMutant] = field(default_factory=list)
    texts: tuple[ProgramText, ...] = ()
    providers: dict[Place, str] = field(default_factory=dict)
    _at_place: dict[Place, Activation] = field(default_factory=dict)

    @classmethod
    def of(cls, planned: Mapping[str, Planned]) -> PlantedFaults:
        """Index what each provider made of a baseline."""
        made = cls()
        for provider, found in planned.items():
            made.texts += found.texts
            made.providers.update((place, provider) for _, place in found.reached)
            for item in found.mutants:
                if item.reason is None:
                    made.add(item)
                elif provider not in (CALLS, MESSAGES):
                    made.left_out_beforehand.append(item)
        return made

    def add(self, item: PlannedMutant) -> None:
        """Add a mutant, and controls at its place."""
        self.by_id[item.mutant.id] = item
        if item.active is not None:
            self._at_place.setdefault(Place.of(item.mutant), item.active)

    def active(self, mutant: Mutant) -> Activation:
        """Return the activation of a mutant, or of a control at the place of one."""
        if mutant.family == CONTROL:
            return self._at_place[Place.of(mutant)].control(is_fatal=mutant.operator != Identity.name)
        found = self.by_id[mutant.id].active
        assert found is not None  # else it was left out
        return found

    def instrumentation(self, mutants: Iterable[Mutant]) -> Instrumentation | None:
        """Return what to put into the program text for these mutants; None if they have no place in it."""
        needed = {place for mutant in mutants for place in self.active(mutant).places}
        return Instrumentation(self.texts).only(needed) if needed else None


@dataclass(slots=True)
class Sources:
    """The project's source files, read when first needed.

    Attributes:
        root: the project's root.
    """

    root: Path
    _names: dict[str, Mapping[Extent, tuple[str, int]]] = field(default_factory=dict)
    _read: dict[tuple[str, Callable[[str], Any]], Any] = field(default_factory=dict)

    def places(self, sites: Iterable[SiteSeen]) -> dict[int, Place]:
        """Return the places that a process reported, by their index in its traces."""
        return {seen.index: self._place(seen) for seen in sites}

    def _place(self, seen: SiteSeen) -> Place:
        span = seen.span
        if span.file not in self._names:
            self._names[span.file] = self.found_in(span.file, front_end_of(span.file).names) or {}
        text, occurrence = self._names[span.file].get(_extent(span), (f"line {span.line}", 1))
        site = Site(span, text, occurrence, Role.ORACLE if seen.oracle else Role.PROGRAM)
        return Place(site, seen.operation, seen.pattern)

    def is_among(self, span: Span, find: Callable[[str], frozenset[Extent]]) -> bool:
        """Return whether ``find`` finds an expression in the text of its file, if that is Python."""
        return _extent(span) in (self._found_in_python(span.file, find) or ())

    def found_at(self, span: Span, find: Callable[[str], Mapping[Extent, _T]]) -> _T | None:
        """Return what ``find`` finds of an expression in the text of its file; None if it finds nothing."""
        found: Mapping[Extent, _T] | None = self._found_in_python(span.file, find)
        return None if found is None else found.get(_extent(span))

    def _found_in_python(self, file: str, find: Callable[[str], Any]) -> Any:
        return self.found_in(file, find) if front_end_of(file) is PYTHON else None

    def found_in(self, file: str, find: Callable[[str], Any]) -> Any:
        """Return what ``find`` finds in the text of a file; None if the file cannot be read."""
        if (file, find) not in self._read:
            try:
                found = find(front_end_of(file).text_of((self.root / file).read_bytes()))
            except (OSError, SyntaxError, ValueError):
                found = None
            self._read[file, find] = found
        return self._read[file, find]


def _extent(span: Span) -> Extent:
    return (span.line, span.column, span.end_line, span.end_column)


@dataclass(slots=True)
class Baseline(Original):
    """What the baseline knows about the original.

    Other packages change it by its methods alone: each stands for something that was learned.

    Attributes, beside those that all providers of faults know:
        reaching: (round, place) to the tests that reach it, fastest first.
        observations: (round, test) to what is compared with a mutant's.
        unstable: tests excluded as flaky, with the reason, by (round, test).
        below: (round, place, test) to the origins of the processes below the tests that reach the place.
        flaky_reaching: (round, place) to the tests that reach it but are excluded in this round.
        exits: per round, the exit code of the suite on the original.
        probe_intervals: after every how many commands probes are read along the way, by round and test.
        refused: (round, test) to the calls that the robot refuses there: see ``Job.refused``.
        nondeterministic: (round, test) whose trace or probes differ between repetitions; never compared.
        doubted: tests that have failed once where equal runs pass.
        inexact: (round, test) that were not the same to the last bit in all runs of the original.
        skipped: number of tests that skipped themselves.
        startup: seconds from a worker's start to the end, less the tests; the longest.
        faults: the mutants of the plan.
        remarks: what is to be known about the vocabulary.
        known: see ``Job.known``.
        early: places that are reached before any test begins, while the program or a test file is imported:
            a mutant there acts in all tests.
        collected: per round, all that the original collects.
        shares_files: whether runs see each other's files.
        may_share: whether the original runs alike in copies of one process that has collected the tests.
        untested: what no test reaches of the program.
        further: by test, what is compared in runs with seeds of rounds in which no mutant runs.
        out_of_reach: by round and test, see ``out_of_reach.files_out_of_reach``.
    """

    reaching: dict[tuple[int, Place], tuple[str, ...]] = field(default_factory=dict)
    below: dict[tuple[int, Place, str], set[str]] = field(default_factory=dict)
    observations: dict[tuple[int, str], Observation] = field(default_factory=dict)
    unstable: dict[tuple[int, str], str] = field(default_factory=dict)
    probe_intervals: Mapping[int, Mapping[str, int]] = field(default_factory=dict)
    refused: dict[tuple[int, str], tuple[RefusedAt, ...]] = field(default_factory=dict)
    nondeterministic: set[tuple[int, str]] = field(default_factory=set)
    inexact: set[tuple[int, str]] = field(default_factory=set)
    doubted: set[str] = field(default_factory=set)
    flaky_reaching: dict[tuple[int, Place], list[str]] = field(default_factory=dict)
    exits: dict[int, int] = field(default_factory=dict)
    skipped: int = 0
    startup: float = 0.0
    faults: PlantedFaults = field(default_factory=PlantedFaults)
    remarks: tuple[Remark, ...] = ()
    known: tuple[tuple[Span, str], ...] = ()
    early: set[Place] = field(default_factory=set)
    shares_files: bool = False
    may_share: bool = True
    collected: dict[int, frozenset[str]] = field(default_factory=dict)
    untested: Untested = field(default_factory=Untested)
    further: dict[str, list[Observation]] = field(default_factory=dict)
    out_of_reach: dict[tuple[int, str], dict[str, str]] = field(default_factory=dict)
    _in_order: dict[tuple[int, frozenset[str] | None], tuple[str, ...]] = field(default_factory=dict)
    _probe_spreads: dict[tuple[int, str], ProbeSpread] = field(default_factory=dict)

    def suite(self, round: int) -> tuple[str, ...]:
        """Return the tests that a mutant is run with, in order: those that are reliable in this round."""
        return tuple(self.tests[round])

    def aside(self, round: int, tests: Collection[str]) -> tuple[str, ...]:
        """Return the tests that the original collects in a round, other than these."""
        return tuple(sorted(self.collected.get(round, frozenset()).difference(tests)))

    def tests_reaching(self, round: int, mutant: Mutant) -> tuple[str, ...]:
        """Return the tests that reach a mutant, quickest first."""
        return self.reaching.get((round, Place.of(mutant)), ())

    def tests_from_first_reach(self, round: int, mutant: Mutant) -> tuple[str, ...]:
        """Return the tests that can notice a mutant, in their order: all from the first on that reaches it.

        Of a fault of which nothing is left after a test, those that reach it.
        """
        reaching, suite = set(self.tests_reaching(round, mutant)), self.suite(round)
        if self.is_of_tests(mutant):
            return tuple(test for test in suite if test in reaching)
        first = next((number for number, test in enumerate(suite) if test in reaching), len(suite))
        return suite[first:]

    def is_exclusive(self, round: int) -> bool:
        """Return whether nothing may run beside the suite: other processes would get in its way."""
        return self.shares_files or self.why_exclusive(round) is not None

    def why_exclusive(self, round: int) -> tuple[str, str] | None:
        """Return a test that disturbs other processes, and in which way; None if the suite has none."""
        ends = ((test, self.ends[round, test].exclusive) for test in self.tests[round])
        return next(((test, why) for test, why in ends if why is not None), None)

    def is_apart(self, mutant: Mutant) -> bool:
        """Return whether a mutant needs a process of its own, as it is active before any point to fork at."""
        return not self.faults.active(mutant).keys

    def is_of_tests(self, mutant: Mutant) -> bool:
        """Return whether only tests that reach a mutant judge it."""
        return mutant.family != CONTROL and self.faults.active(mutant).is_of_tests

    def is_early(self, mutant: Mutant) -> bool:
        """Return whether a mutant may act before any test begins."""
        return Place.of(mutant) in self.early

    def add_planned(self, planned: Mapping[str, Planned]) -> None:
        """Add the mutants that the providers have planned, by provider, and the places that tests reach."""
        self.faults = PlantedFaults.of(planned)
        for made in planned.values():
            self.early |= made.early
            for key, origins in made.below.items():
                self.below.setdefault(key, set()).update(origins)
            for (round, place), tests in made.reached.items():
                self.reach(round, place, None if place in made.early else frozenset(tests))

    def reach(self, round: int, place: Place, tests: Collection[str] | None) -> None:
        """Note that these tests reach a place in a round; None is a place that affects all tests."""
        aside = [test for where, test in self.unstable if where == round and (tests is None or test in tests)]
        self.reaching[round, place] = self._fastest_first(round, tests if tests is None else frozenset(tests))
        if aside:
            self.flaky_reaching[round, place] = aside

    def _fastest_first(self, round: int, tests: frozenset[str] | None) -> tuple[str, ...]:
        # a suite may have ten thousand tests, and thousands of places that the same of them reach
        if (round, tests) not in self._in_order:
            if tests is None:
                order = sorted(self.tests[round], key=lambda test: cost(self.ends[round, test]))
            else:
                order = [test for test in self._fastest_first(round, None) if test in tests]
            self._in_order[round, tests] = tuple(order)
        return self._in_order[round, tests]

    def reach_below(self, round: int, place: Place, test: str, origin: str) -> None:
        """Note that a test reaches a place in a process below it of this origin."""
        self.below.setdefault((round, place, test), set()).add(origin)

    def reach_in_vain(self, round: int, test: str, places: Iterable[Place]) -> None:
        """Note that an excluded test reaches these places."""
        for place in places:
            tests = self.flaky_reaching.setdefault((round, place), [])
            if test not in tests:
                tests.append(test)

    def is_missed(self, round: int, mutant: Mutant, end: TestEnd) -> bool:
        """Return whether processes below this test, which passed, may have run as the original.

        The test reaches the mutant in processes of an origin in which it was not hit.
        """
        reached = self.below.get((round, Place.of(mutant), end.test), set())
        return end.outcome != "failed" and not reached <= set(end.hit_below)

    def seconds(self, round: int, tests: Iterable[str]) -> float:
        """Return the wall-clock time that tests took in a round, in s."""
        return sum(self.ends[round, test].wall for test in tests)

    def add_remarks(self, remarks: Iterable[Remark]) -> None:
        """Add remarks on the vocabulary or the configuration."""
        self.remarks = (*self.remarks, *remarks)

    def plant(self, item: PlannedMutant) -> None:
        """Add a mutant that the plan does not have, with controls at its place."""
        self.faults.add(item)

    def doubt(self, test: str) -> None:
        """Note that a test failed once where equal runs pass: its kills may be chance."""
        self.doubted.add(test)

    def compare_runs(self, round: int, end: TestEnd, found: Observation, vocabulary: Vocabulary) -> None:
        """Compare a further run of a test of the original with the first.

        Only what both have alike can be compared with a mutant's.
        """
        key = (round, end.test)
        first = self.observations[key]
        if found == first and end.simulated == self.ends[key].simulated:
            return
        # the first run of all is not read along the way, so nothing differs there
        comparable = found if first.moments else replace(found, moments=first.moments)
        if comparable != first or end.simulated != self.ends[key].simulated:
            self.inexact.add(key)
        steady = as_steady(first, found, vocabulary.probes, vocabulary.operations)
        if steady is None:
            self.nondeterministic.add(key)
        else:
            self.observations[key] = steady

    def add_seed(self, found: Mapping[str, Observation]) -> None:
        """Add a run of the original, by test, with the seed of a round in which no mutant runs."""
        for test, value in found.items():
            self.further.setdefault(test, []).append(value)

    def probe_spread(self, round: int, test: str, probes: Sequence[Probe]) -> ProbeSpread:
        """Return how far probes are apart in runs of a test with other seeds than that of the round."""
        key = (round, test)
        if key not in self._probe_spreads:
            rounds = range(len(self.tests))
            others = [
                self.observations[other, test] for other in rounds if (other, test) in self.observations
            ]
            others += self.further.get(test, [])
            self._probe_spreads[key] = ProbeSpread.between(self.observations[key], others, probes)
        return self._probe_spreads[key]

    def set_aside(self, round: int, test: str, reason: str) -> None:
        """Exclude a flaky test: from now on no mutant is judged by it in this round."""
        self.unstable[round, test] = reason
        self.tests[round] = [other for other in self.tests[round] if other != test]
        self._in_order.clear()
        for (where, place), tests in self.reaching.items():
            if where == round and test in tests:
                self.reaching[where, place] = self._fastest_first(round, frozenset(tests))
                self.reach_in_vain(where, test, [place])

    def ran(self, round: int) -> list[str]:
        """Return the tests of a round that were not skipped."""
        return [test for test in self.tests[round] if self.ends[round, test].outcome != "skipped"]

    def missing_judges(self, round: int, mutant: Mutant) -> dict[str, str]:
        """Return the tests that might notice a mutant but do not judge it in this round: why not.

        These are tests excluded as flaky that reach it, also in other rounds: one that fails may stop short
        of a place. And tests that run its file in processes that cannot join the campaign: there acts only
        what changes the file itself.
        """
        place, rounds = Place.of(mutant), range(len(self.tests) if self.unstable else 0)
        reaching = {
            test
            for known in (self.reaching, self.flaky_reaching)
            for other in rounds
            for test in known.get((other, place), ())
        }
        aside = [test for where, test in self.unstable if where == round and test in reaching]
        return dict.fromkeys(aside, "it is excluded in this round") | self._unjudged(round, mutant)

    def _unjudged(self, round: int, mutant: Mutant) -> dict[str, str]:
        if not self.out_of_reach or mutant.family == CONTROL:
            return {}
        in_file = mutant.site.is_in_file
        if in_file and self.faults.active(mutant).reference != CALL_FAULT:
            return {}
        ends_with_test = self.tests_reaching(round, mutant) if self.is_of_tests(mutant) else None
        files = {span.file for span in mutant.site.spans} if in_file else None
        return {
            test: f"the mutant does not act in a process that it starts: {found[file]}"
            for (where, test), found in self.out_of_reach.items()
            for file in sorted(found if files is None else files & found.keys())[:1]
            if where == round and (ends_with_test is None or test in ends_with_test)
        }


def cost(end: TestEnd) -> tuple[float, int]:
    """Return what a test costs, in a measure that is the same in every run, unlike wall-clock time."""
    return (end.simulated or 0.0, end.operations)


def observation(end: TestEnd, places: Mapping[int, Place]) -> Observation:
    """Return what is compared of a test: its calls, and the probes at its end."""
    # a campaign holds many traces: the calls of a site share the objects that identify it
    known = {}
    for index in {call[0] for call in end.trace}:
        place = places[index]
        known[index] = place.key, (place.operation, place.pattern)
    events = []
    for index, written, read, _ in end.trace[:TRACE_LIMIT]:
        key, what = known[index]
        events.append(TraceCall(key, written, read, what))
    prepared, called = end.returned[: end.prepared], end.returned[end.prepared :]
    return Observation(
        events, end.probes, end.truncated, end.unread, end.outcome, prepared, called, end.moments
    )


def refusals_by_test(result: Result, places: Mapping[int, Place]) -> dict[str, tuple[RefusedAt, ...]]:
    """Return the calls that the robot refused in a run, by test; ``places`` are those of its traces."""
    found: dict[str, tuple[RefusedAt, ...]] = {}
    for end in result.ends:
        numbers: dict[int, list[int]] = {}
        for index, number in sorted({*end.refused_calls}):
            numbers.setdefault(index, []).append(number)
        of_places = ((places[index], tuple(those)) for index, those in numbers.items())
        calls = tuple(RefusedAt(item.site, item.operation, item.pattern, those) for item, those in of_places)
        found |= {end.test: calls} if calls else {}
    return found
