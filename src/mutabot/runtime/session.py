"""A session in the process of the tests: its job, its hooks in the program, and its tests."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from random import Random
from typing import TYPE_CHECKING, Any

from mutabot.evidence import recorder
from mutabot.model.activation import CALL_FAULT
from mutabot.model.events import Acted, Called, CallsAsked, Event, KnownLater, Noted, SiteSeen, TextsSeen
from mutabot.model.job import Idle
from mutabot.model.operation import owner_of
from mutabot.runtime.fault_runner import FaultRunner
from mutabot.runtime.inspection import Inspection
from mutabot.runtime.interception.active_mutant import is_refusal
from mutabot.runtime.interception.adapter import Adapter, SiteCall, handles_of
from mutabot.runtime.interception.dispatcher import Dispatcher, Untracked
from mutabot.runtime.interception.guarding import CallGuards, OperationGuard
from mutabot.runtime.interception.trace import Answers, Locator, Recorder, seen_by
from mutabot.runtime.meter import Meter
from mutabot.runtime.observation.clock import ClockReader, Instances, ProgramTime
from mutabot.runtime.observation.probes import Along, Reading, TestRecording, first_reading, take
from mutabot.runtime.program_text.call_sites import CallSites
from mutabot.runtime.program_text.call_targets import CallFindings, CallTargets, PassedCallables
from mutabot.runtime.program_text.instrument import SessionText
from mutabot.runtime.reached_keys import ReachedKeys
from mutabot.runtime.seeds import derive
from mutabot.runtime.targets.callables import Callables
from mutabot.runtime.targets.messages import Messages
from mutabot.runtime.targets.target import Finding, Handler

if TYPE_CHECKING:  # processes below the tests do not fork mutants
    from mutabot.model import Moment, Mutant, Operation, Probe
    from mutabot.model.activation import Activation, Key
    from mutabot.model.job import Job
    from mutabot.model.quantity import Value
    from mutabot.runtime.activity import Activity
    from mutabot.runtime.event_file import EventWriter
    from mutabot.runtime.interception.active_mutant import MutatedSite
    from mutabot.runtime.isolation.files import PrivateFiles
    from mutabot.runtime.isolation.fork_parent import ForkParent
    from mutabot.runtime.program_text.returns import Returns


class Session:
    """The session of a job.

    Args:
        job: what to do.
        writer: where reports go.
        locator: finds the site of a frame, and of a function that is called back.

    Attributes:
        recorder: traces; always kept, since survivors are compared with the original.
        callables, messages: what stands around the vocabulary's targets; no messages where none is asked for.
        targets: those that there are of the two.
        dispatcher: the way of the program's calls.
        inspection: what is wrong with the vocabulary.
        is_fork: whether this process was forked to be its mutant.
        text: the program text, if it is instrumented.
        call_sites: calls that are seen where they are written.
        call_targets: what stands there.
        returns: what the program returns to its tests; None if that is not noted.
        recording: what the world does while the test runs.
        test: node id of the running test.
        noted: in the baseline, calls of the running test that the robot refused, or that returned its memory.
        on_noted: called with each of them; None if not wanted.
        fault: the fault of this process; idle in the original's.
        files: what keeps the files of this process apart; None in processes below the tests.
        fork_parent: forks for each mutant, while this process runs the original; else None.
        guards: what stands before every operation; None if there are no guards.
    """

    call_sites: CallSites
    call_targets: CallTargets

    def __init__(self, job: Job, writer: EventWriter, locator: Locator) -> None:
        self.job, self.writer, self.locator = job, writer, locator
        self.recorder = Recorder(self._site_seen)
        self.recording = TestRecording(self._simulated, self.untracked, job.vocabulary.clock is not None)
        self.instances = Instances()
        self.along = Along(partial(self._read_probes, along=True))
        self.inspection = Inspection(job.vocabulary, job.inspect, self._send)
        self.fault = FaultRunner(self, lambda mutant: Random(self.seed_of(mutant)))
        self.fork_parent: ForkParent | None = None
        self.files: PrivateFiles | None = None
        self.reached = ReachedKeys(self._reach, self.fault.tick)
        self.callables = Callables(self.inspection.target_is_wrong)
        self.messages: Messages | None = None
        self.targets: list[Callables | Messages] = [self.callables]
        self.dispatcher = Dispatcher(locator, self.recorder, self.instances, self.along, self._raised)
        self.dispatcher.oracle_nodes = job.oracle_nodes
        self.dispatcher.on_end = self.inspection.note if job.inspect else None
        self.is_fork = False
        self.text: SessionText | None = None
        self.returns: Returns | None = None
        self.test = ""
        self.noted: dict[Noted, None] = {}
        self.on_noted: Callable[[Noted], None] | None = None
        self._adapters: list[Adapter] = []
        targets = frozenset(operation.target for operation in job.vocabulary.operations)
        self.guards = CallGuards.load(job.guards, self.untracked, lambda: self.meter, targets)
        self._lately: dict[str, Mapping[str, Value]] = {}
        self._asked: list[Adapter] = []
        self._asking: list[tuple[str, str | None, Idle]] = []
        self._time = ProgramTime(job.vocabulary, lambda: self.meter, self.instances)
        self._main_thread = threading.main_thread().ident
        self._sees_itself: set[Handler] = set()

    def install(self) -> None:
        """Intercept all operations of the vocabulary, and activate the mutant."""
        self.text = SessionText.of(self.job, self.writer, self.acted)
        if self.returns is not None:
            self.returns.install()  # after the alternatives, which are found by where they stand
        vocabulary = self.job.vocabulary
        for operation in vocabulary.operations:
            handler = self._handler(operation)
            if operation.kind == "messages":
                self._heeded().wrap(operation.target, handler)
            elif operation.kind is None:
                self.callables.wrap(operation.target, handler, is_set=bool(operation.described))
        self._see_calls()
        waits = [vocabulary.wait.target] if vocabulary.wait is not None else []
        self.instances.watch(map(owner_of, (*waits, *(probe.target for probe in vocabulary.probes))))
        if vocabulary.clock is not None:
            clock = vocabulary.clock
            reader = ClockReader(clock, lambda: self.meter, self._clock_is_wrong, self.reached.tick)
            self.callables.wrap(clock.tick, reader.handle)
        self._listen()
        self._find_answer_readers()
        if self.job.record or self.job.serving is not None:
            # what the program does while it is imported counts for every test that comes after
            self.dispatcher.meter = Meter()
            is_original = self.job.mutant is None
            self.recorder.answers = Answers(handles_of(vocabulary)) if is_original else None
        if self.job.mutant is not None:
            self._take_on(self.job.mutant, self.job.active[self.job.mutant.id])

    def _find_answer_readers(self) -> None:
        """Find the mutants of the job that may ask for a command's last answer."""
        idle = [
            (mutant, Idle.of(mutant.idle)) for mutant in self._mutants_of_job() if mutant.idle is not None
        ]
        self._asking = [
            (mutant.operation, mutant.pattern, answers) for mutant, answers in idle if answers.varying
        ]
        self._remember_answers()

    def _remember_answers(self) -> None:
        """Store, in the running test, only answers that a mutant may ask for."""
        now = (self.job.round, self.test)
        asked = {(target, pattern) for target, pattern, idle in self._asking if idle.is_varying(*now)}
        for adapter in self._adapters:
            adapter.remembers = {text for target, text in asked if target == adapter.operation.target}

    def _mutants_of_job(self) -> list[Mutant]:
        mutants = list(self.job.forking.mutants) if self.job.forking is not None else []
        return mutants + ([self.job.mutant] if self.job.mutant is not None else [])

    def _see_calls(self) -> None:
        """Intercept calls at their sites, whatever replaces an operation there."""
        called = [adapter for adapter in self._adapters if adapter.operation.kind in (None, "methods")]
        self.call_targets = CallTargets(called, self.callables, self.locator, self._sees_itself)
        self._report_replacements()
        names = {adapter.operation.last_name for adapter in called}
        handing = PassedCallables(self.call_targets, self.dispatcher.given)
        self.call_sites = CallSites(names, self.locator.role, self.call_targets, self._sees_itself, handing)
        self.call_sites.install()

    def _report_replacements(self) -> None:
        """Report what the baseline observed at the sites of the job's mutants."""
        of_mutants = {m.site.span: m.operation for m in self._mutants_of_job() if m.operation}
        self.call_targets.known = of_mutants | dict(self.job.known)  # what the baseline counted, counts
        if self.job.inspect:
            self.call_targets.noted = CallFindings(lambda: self.test, self.locator.relative)

    def _listen(self) -> None:
        """Receive messages that may show refusals, or the robot's position."""
        operations = self.job.vocabulary.operations
        asked = {name for operation in operations for name in operation.currents}
        refusals = (refusal for operation in operations for refusal in operation.all_refused)
        self._asked = [adapter for adapter in self._adapters if adapter.operation.target in asked]
        if any(refused.topic is not None for refused in refusals) or any(
            adapter.operation.named is not None for adapter in self._asked
        ):
            self._heeded().on_heard = self._on_message

    def _heeded(self) -> Messages:
        """Return the names on middlewares, which are hooked when they are first needed."""
        if self.messages is None:
            self.messages = Messages(self.inspection.target_is_wrong)
            self.targets.append(self.messages)
        return self.messages

    def _on_message(self, name: str, message: Any) -> None:
        if self.mutant is not None:
            self.mutant.heard(name, message)
        self.dispatcher.refused.heard(name, message)
        for adapter in self._asked:
            adapter.observe_message(name, message)

    def _handler(self, operation: Operation) -> Handler:
        """Return the handler of an operation, with an adapter of its own."""
        vocabulary = self.job.vocabulary
        readings = {name: vocabulary.operation(name) for name in operation.currents}
        is_wrong = partial(self.inspection.path_is_wrong, operation)
        time = (self._time.now, self._time.wait)
        parts = self._lately, handles_of(vocabulary), *time
        adapter = Adapter(operation, readings, is_wrong, *parts)
        if self.guards is not None:
            adapter.guard = OperationGuard(self.guards, Adapter(operation, readings, is_wrong, *parts))
        self._adapters.append(adapter)
        adapter.handler = self.dispatcher.handler(adapter)
        self._sees_itself.add(adapter.handler)
        return adapter.handler

    @property
    def mutant(self) -> MutatedSite | None:
        """The active mutant of calls; None for the original, and for other mutants."""
        return self.dispatcher.mutant

    @property
    def meter(self) -> Meter | None:
        """What the running test has used; None between tests."""
        return self.dispatcher.meter

    @property
    def activity(self) -> Activity:
        """What the mutant did in the running test."""
        return self.fault.activity

    def look_back(self, *, at_all: bool = False) -> None:
        """Check whether the program has written to copies that the mutant passed on."""
        if self.mutant is not None:
            self.mutant.look_back(at_all=at_all)

    @property
    def commands(self) -> int:
        """The number of the running test's calls that made the robot act."""
        return sum(adapter.commands for adapter in self._adapters)

    def _take_on(self, mutant: Mutant, activation: Activation) -> None:
        """Become a mutant."""
        self.fault.take_on(mutant, activation)
        self._watch(activation.keys)

    def _watch(self, keys: Iterable[Key]) -> None:
        self.reached.watch(keys)
        activation = self.fault.activation
        # a mutant of calls meets its own by itself
        is_asked = activation is None or activation.reference != CALL_FAULT
        self.dispatcher.on_reach = self.reached.call if is_asked and self.reached.asks_calls else None

    def _reach(self, keys: list[Key], number: int | None) -> None:
        """Note keys that the running test reaches, at a call of this number among those of its site."""

        def is_due(mutant: Mutant) -> bool:
            return number is None or mutant.moment is None or self.is_moment(mutant, number)

        if self.fork_parent is not None:
            self.fork_parent.reach(*keys, is_due=is_due)
        for key in keys:  # this process may be the fork by now
            self.fault.reach(key)

    def grow(self, parent: ForkParent) -> None:
        """Become a fork parent: run the original, and fork where a mutant of the parent first differs."""
        self.fork_parent = parent
        self._watch_text()
        self._watch(parent.keys)

    def _watch_text(self) -> None:
        if self.text is not None and self.fork_parent is not None:
            self.text.watch(self.fork_parent.reach_alternatives, self.fork_parent.places())

    def become(self, mutant: Mutant, activation: Activation) -> None:
        """Become this mutant, in a process that was just forked."""
        self.fork_parent, self.is_fork = None, True
        if self.meter is not None:
            self.meter.continue_in_copy()
        if self.text is not None:
            self.text.alternatives.on_place = None
            self.text.alternatives.activate()
        self._take_on(mutant, activation)

    def take_on(self, job: Job, writer: EventWriter) -> None:
        """Continue with a job of the same program and vocabulary. What was installed stays."""
        self.job, self.writer = job, writer
        self.inspection.is_asked = job.inspect
        self._find_answer_readers()
        self.dispatcher.on_end = self.inspection.note if job.inspect else None
        self._report_replacements()
        if self.text is not None:
            self.text.writer = writer

    def start_test(self, test: str, fixtures: Callable[[], Iterable[Any]] | None = None) -> None:
        """Begin a test, before its fixtures.

        ``fixtures`` returns the objects that they hold; None in a process below the tests.
        """
        if self.meter is not None and not self.test:  # the first test
            for call in self.recorder.trace:
                self.writer.send(Called(*call))
        self.test = test
        self.note_modules()
        self.dispatcher.meter = Meter(self.job.simulated.get(test), self.job.spare)
        is_baseline = self.job.record and self.job.mutant is None and self.job.forking is None
        self.recorder.answers = Answers(handles_of(self.job.vocabulary)) if is_baseline else None
        self.recorder.start()
        self.recorder.clock = recorder.now if self.job.evidence else None
        self.instances.start(fixtures)
        self.dispatcher.calls.clear()
        self.noted.clear()
        self.dispatcher.on_live = self._note if is_baseline else None
        self.dispatcher.refused.on_refused = partial(self._note, is_refused=True) if is_baseline else None
        self.dispatcher.refused.start(self.job.refused.get(test, ()))
        self.along.start(self.job.moments.get(test, 0))
        if self.returns is not None:
            self.returns.start()
        self._remember_answers()
        for adapter in self._adapters:
            adapter.reset()
        if self.text is not None:
            self.text.start_test(test)
            self._watch_text()
        self.reached.start_test()
        if self.guards is not None:
            self.guards.start_test()
        self.fault.start_test()
        self.recording.start(test, is_wanted=self.job.evidence)

    def note_modules(self) -> None:
        """Note which names denote operations in the modules that were just loaded."""
        self.call_targets.note_modules(self.call_sites.loaded)

    def change_file(self, path: str, content: bytes) -> None:
        """Change a file of the project for this process; see ``FaultContext.change_file``."""
        self.dispatcher.refused.changed[path] = content
        if self.files is not None:  # else this process is below one that has changed it
            self.files.change(path, content)

    def untracked(self) -> Untracked:
        """Return a context in which calls are not attributed to the program."""
        is_main = threading.get_ident() == self._main_thread  # at every step of a simulator
        return Untracked(self.returns if is_main else None)

    @property
    def round(self) -> int:
        """The round, from 0."""
        return self.job.round

    @property
    def seconds(self) -> float | None:
        """Simulated seconds since the first tick of the running test; None without a clock."""
        return self._time.now_if_known()

    def seed_of(self, mutant: Mutant) -> int:
        """Return a seed that all magnitudes of a fault share, so that they differ in size only."""
        return derive(self.job.seed, self.job.round, self.test, mutant.ladder or mutant.id)

    def moment_of(self, mutant: Mutant) -> Moment | None:
        """Return at which calls of the running test a mutant acts; None for all."""
        if mutant.moment is None:
            return None
        seed = derive(self.job.seed, self.job.round, self.test, mutant.site.id, "moment")
        return mutant.moment.drawn(self.job.round, self.test, seed)

    def is_moment(self, mutant: Mutant, number: int) -> bool:
        """Return whether a mutant acts at this call of its site in the running test."""
        moment = self.moment_of(mutant)
        return moment is None or moment.holds(number, self.seconds)

    def end_test(self) -> None:
        """End the test, after its fixtures."""
        self.dispatcher.meter = None
        if self.text is not None:
            if self.fork_parent is not None:
                self.fork_parent.report_undiverged(self.text.alternatives.hits)
            self.text.end_test()

    def take_probes(self) -> Reading:
        """Read all probes, at the end of a test, before its fixtures are torn down."""
        self.look_back(at_all=True)
        if self.returns is not None:
            self.returns.stop()
        self.along.stop()
        self.recording.stop()
        reading = first_reading(self._read_probes)
        self.instances.let_go()  # what the program is done with may go
        return reading

    def _read_probes(self, *, along: bool = False) -> Reading:
        meter, self.dispatcher.meter = self.meter, None  # probes are no operations of the program's
        try:
            with Untracked(self.returns):
                return self._along() if along else take(self.job.vocabulary.probes, self.instances)
        finally:
            self.dispatcher.meter = meter

    def _along(self) -> Reading:
        """Read the probes along the way, in program files as the original.

        A mutant may be waited for there, and is counted where it acts. Other threads that run the program may
        be in the middle of what such a probe reads.
        """
        probes = self.job.vocabulary.probes
        if self.text is None or self.text.sightings is not None or not any(map(self._is_of_program, probes)):
            return take(probes, self.instances)
        if threading.active_count() > 1:
            return take(tuple(probe for probe in probes if not self._is_of_program(probe)), self.instances)
        with self.text.alternatives.paused():
            return take(probes, self.instances)

    def _is_of_program(self, probe: Probe) -> bool:
        file = getattr(sys.modules.get(probe.target.partition(":")[0]), "__file__", None) or ""
        return self.returns is not None and self.returns.wants(file)

    def finish(self, texts: Iterable[TextsSeen] = ()) -> None:
        """Wait, after all tests, for forks, report observations, and check the vocabulary if asked to.

        ``texts`` is what processes below the tests saw of the program text.
        """
        if self.fork_parent is not None:
            self.fork_parent.finish()
        if self.text is not None:
            self.text.finish(texts)
        if self.job.record and self.job.mutant is None:
            # of sites at which an operation stood in some tests and something unknown in others
            stood = self.call_targets.stood | {seen.span: seen.operation for seen in self.recorder.sites}
            for span in sorted(self.call_targets.alone & stood.keys()):
                self._send(KnownLater(span, stood[span]))
            self._send(self.intercepted_calls())
        if self.job.inspect:
            self.inspect_targets()
            if self.call_targets.noted is not None:
                for operation, finding in self.call_targets.noted.findings(self.job.vocabulary.operations):
                    self.inspection.report(operation.source, finding)

    def intercepted_calls(self) -> CallsAsked:
        """Return which calls were intercepted until now, and which replacements were called."""
        files = sorted(map(self.locator.relative, self.call_sites.asked))
        alone, unmeant = self.call_targets.alone, self.dispatcher.unmeant | self.call_targets.wrapped
        return CallsAsked(tuple(files), tuple(sorted(alone)), tuple(sorted(unmeant)))

    def inspect_targets(self) -> None:
        """Check every target of the vocabulary, including those that no test has reached."""
        self.inspection.inspect(self.targets)

    def _raised(self, error: BaseException, made: SiteCall) -> None:
        names = self.refusals_of(made.call.operation)
        refused = self.dispatcher.refused
        if not is_refusal(error, names):
            return
        if refused.on_refused is not None:
            refused.on_refused(made)
        if not refused.has(made):
            self.fault.refused(error, made.call)

    def _note(self, made: SiteCall, *, is_refused: bool = False) -> None:
        """Note that the robot refused a call of the original, or returned its own memory."""
        index = self.recorder.index_of(replace(seen_by(made), direct=False, stands_in=False))
        note = Noted(index, made.number if is_refused else None)
        if note not in self.noted and self.on_noted is not None:
            self.on_noted(note)
        self.noted[note] = None

    def failure_in(self, error: BaseException) -> str | None:
        """Return how the mutant's own code failed, if it is the source of an exception; None if it is not."""
        operations = self.job.vocabulary.operations
        robots = {operation.target.partition(":")[0] for operation in operations if operation.named is None}
        return self.fault.failure_in(error, robots, self.locator)

    def refusals_of(self, operation: Operation) -> frozenset[str]:
        """Return names of the exceptions by which the robot refuses a call of an operation."""
        return frozenset((*operation.refusals, *self.job.vocabulary.refusals))

    def _send(self, line: Event) -> None:
        self.writer.send(line)  # which is another one once a copy knows its job

    def _site_seen(self, site: SiteSeen) -> None:
        if not self.is_fork:  # a fork sends its sites with its end
            self.writer.send(site)

    def acted(self) -> None:
        """Report that the fault changed something in the running test."""
        self._report_acted(recorder.now())

    def acted_in_call(self) -> None:
        """Note that the mutant acted in a call, at the time when the call began."""
        self._report_acted(self.recorder.began)

    def _report_acted(self, seconds: float | None) -> None:
        self.recording.note_fault(len(self.recorder.trace), seconds)
        self.writer.send(Acted(self.test))

    def _simulated(self) -> float | None:
        meter = self.dispatcher.meter
        return meter.simulated if meter is not None else None

    def in_mutated_call(self, began: bool) -> None:
        """Mark the start of a mutated call, by its time, or its end, by None."""
        self.writer.send(Acted(self.test, began))

    def _clock_is_wrong(self, key: str, text: str) -> None:
        clock = self.job.vocabulary.clock
        self.inspection.report(clock.source if clock is not None else "", Finding(key, text))
