"""One session inside: the job at hand, and what happens at every intercepted call."""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Callable
from contextlib import nullcontext
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import partial
from types import FrameType
from typing import Any

from mutabot.border.job import Budget, Job
from mutabot.border.lines import Acted, CalledAtImport, MutatedCall, Problem, Remark, SiteSeen
from mutabot.errors import PathError
from mutabot.inside.calls.activation import Activation
from mutabot.inside.calls.answers import Answers, Returned, handles_of
from mutabot.inside.calls.door import Door, here
from mutabot.inside.calls.intercept import Handler, Interception, NotFoundError, resolve
from mutabot.inside.calls.overrides import Watch
from mutabot.inside.calls.parameters import look_at
from mutabot.inside.calls.trace import Recorder
from mutabot.inside.fork.trunk import Trunk
from mutabot.inside.readings.along import Along, Rehearsal, rehearse
from mutabot.inside.readings.clock import ClockReader
from mutabot.inside.readings.instances import Instances
from mutabot.inside.readings.probes import Reading, take
from mutabot.inside.text.program_text import Texts
from mutabot.inside.text.returns import Returns
from mutabot.model import Call, Mutant, Operation, Probe, Reply, Role, Span

from .evidence import Evidence, together
from .inspection import why_not_asked
from .limits import Meter
from .pipe import Held, Pipe
from .seeds import derive

#: whether an operation is already under way here: only the outermost is a site
_under_way: ContextVar[bool] = ContextVar("mutabot_operation_under_way", default=False)


@dataclass(slots=True)
class Session:
    """The job at hand.

    Attributes:
        job: what to do.
        pipe: where reports go.
        locate: finds the site of a frame.
        recorder: traces; always kept, since survivors are compared with the original.
        trunk: set while this process runs the original and forks a branch per mutant.
        branch: id of the mutant that this process was forked to be; None in all others.
        activations: the mutants of calls that are at work: none for the original.
        texts: the program text, if it is instrumented.
        returns: what the program returns to its tests; None if that is not noted.
        meter: what the running test has used; None between tests.
        test: node id of the running test.
    """

    job: Job
    pipe: Pipe | Held
    locate: Callable[[FrameType | None], tuple[Span, Role] | None]
    recorder: Recorder = field(init=False)
    interception: Interception = field(init=False)
    instances: Instances = field(default_factory=Instances)
    along: Along = field(init=False)
    rehearsal: Rehearsal = field(default_factory=Rehearsal)
    trunk: Trunk | None = None
    branch: str | None = None
    activations: list[Activation] = field(default_factory=list)
    texts: Texts | None = None
    returns: Returns | None = None
    meter: Meter | None = None
    test: str = ""
    _doors: list[Door] = field(default_factory=list)
    _told: set[tuple[str, str]] = field(default_factory=set)
    _parts: set[str] = field(default_factory=set)
    _askers: dict[str, type | None] = field(default_factory=dict)
    _unfit: dict[tuple[str, str], Callable[[], None]] = field(default_factory=dict)
    _fit: dict[str, set[str]] = field(default_factory=dict)
    _watch: Watch = field(init=False)

    def __post_init__(self) -> None:
        self.recorder = Recorder(self._site_seen)
        self._watch = Watch(self.locate, self._calls_of, _under_way.get)
        self.interception = Interception(self._target_is_wrong)
        self.along = Along(partial(self._read_probes, along=True))

    def install(self) -> None:
        """Put the interception of the whole vocabulary in place, and the mutant with it."""
        self.texts = Texts.of(self.job, self.pipe, partial(self._acted, ""))
        if self.returns is not None:
            self.returns.install()  # after the alternatives, which are found by where they stand
        vocabulary = self.job.vocabulary
        for operation in vocabulary.operations:
            door = self._door(operation)
            overrides = partial(self._handler_of_override, operation) if operation.overrides else None
            self.interception.wrap(operation.target, self._handler(door), overrides)
        self.instances.watch(probe.owner for probe in vocabulary.probes)
        if vocabulary.clock is not None:
            clock = vocabulary.clock
            reader = ClockReader(clock, lambda: self.meter, partial(self._tell, clock.source))
            self.interception.wrap(clock.tick, reader.handler())
        if self.job.mutant is not None:
            self.activate(self.job.mutant)
        if self.job.record or self.job.serving is not None:
            self._watch_imports()

    def _watch_imports(self) -> None:
        """What the program does while it is imported counts for every test that comes after."""
        self.meter = Meter(Budget())
        self.recorder.answers = Answers.of(self.job.vocabulary) if self.job.mutant is None else None
        self._start_activations()

    def _end_imports(self) -> None:
        """The first test begins."""
        if self.meter is None or self.test:
            return
        if self.recorder.trace:
            self.pipe.send(CalledAtImport(tuple(self.recorder.trace)))
        for activation in self.activations:
            activation.keep_early()

    def _door(self, operation: Operation) -> Door:
        reading = self.job.vocabulary.operation(operation.current or "")
        self._doors.append(Door(operation, reading, partial(self._path_is_wrong, operation)))
        self._doors[-1].handles = handles_of(self.job.vocabulary)
        return self._doors[-1]

    def _handler_of_override(self, operation: Operation, kind: type) -> Handler:
        """An overriding method may have a signature of its own, so it has a door of its own."""
        return self._handler(self._door(operation))

    def activate(self, mutant: Mutant) -> None:
        """Take on a mutant; those of the program text are alternatives there."""
        for single in mutant.singles:
            operation = self.job.vocabulary.operation(single.operation)
            if operation is not None:
                refusals = self._refusals(operation)
                on_act = partial(self._acted, single.id)
                made = Activation(single, operation, refusals, on_act, self._in_mutated_call)
                self.activations.append(made)

    def _refusals(self, operation: Operation) -> frozenset[str]:
        return frozenset((*operation.refusals, *self.job.vocabulary.refusals))

    @property
    def evidence(self) -> Evidence:
        """What the mutant did in the running test."""
        found = [activation.evidence for activation in self.activations]
        if self.texts is not None and self.texts.is_mutant:
            found.append(self.texts.evidence)
        return together(found)

    @property
    def commands(self) -> int:
        """Operations of the running test that made the robot do something."""
        return sum(door.commands for door in self._doors)

    def take_on(self, job: Job, pipe: Pipe) -> None:
        """Go on with a job of the same program and vocabulary. What was installed stays."""
        self.job, self.pipe = job, pipe
        if self.texts is not None:
            self.texts.pipe = pipe

    def start_test(self, test: str) -> None:
        """A test begins, before its fixtures."""
        self._end_imports()
        self.test = test
        self._parts.clear()
        self._look_for_subclasses()
        self.meter = Meter(self.job.budgets.get(test, Budget()))
        is_baseline = self.job.record and self.job.mutant is None and self.job.branching is None
        self.recorder.answers = Answers.of(self.job.vocabulary) if is_baseline else None
        self.recorder.start()
        self.instances.start()
        self.along.start(self.job.moments.get(test, 0))
        if self.returns is not None:
            self.returns.start()
        for door in self._doors:
            door.reset()
        if self.trunk is not None:
            self.trunk.start_test(test)
        if self.texts is not None:
            branch = self._branch_at_place if self.trunk is not None else None
            self.texts.start_test(test, branch, self.trunk.places() if self.trunk is not None else {})
        if self.trunk is not None:
            self._become(self.trunk.branch_at_start())
        if self.branch is None:  # else it has just become its mutant
            self._start_activations()

    def _look_for_subclasses(self) -> None:
        """Classes may have been made since the last test."""
        self.interception.look_for_subclasses()
        if not self.job.inspect:
            return
        owners = self.interception.owners
        for target in sorted(owners, key=lambda target: len(owners[target][0].__mro__), reverse=True):
            operation = self.job.vocabulary.operation(target)
            if operation is not None and not operation.overrides:
                self.interception.wrap_overriding(target, partial(self._watch.handler, target))

    def _calls_of(self, target: str) -> int:
        return sum(door.calls for door in self._doors if door.operation.target == target)

    def _start_activations(self) -> None:
        for activation in self.activations:
            seed = derive(self.job.seed, self.job.round, self.test, activation.mutant.id)
            activation.start(seed, self.job.round, self.test)

    def end_test(self) -> None:
        """The test and its fixtures are over."""
        self.meter = None
        if self.texts is not None:
            if self.trunk is not None:
                self.trunk.tell_undiverged(self.texts.hits)
            self.texts.end_test()

    def take_probes(self) -> Reading:
        """Read all probes: at the end of a test, before its fixtures take the world down."""
        if self.returns is not None:
            self.returns.stop()
        self.along.stop()
        reading, self.rehearsal = rehearse(self._read_probes)
        self.instances.start()  # what the program is done with may go
        return reading

    def _read_probes(self, *, along: bool = False) -> Reading:
        meter, self.meter = self.meter, None  # probes are no operations of the program's
        returns = self.returns.pause() if self.returns is not None else nullcontext()
        try:
            with returns:
                return take(self._probes(along=along), self.instances)
        finally:
            self.meter = meter

    def _probes(self, *, along: bool) -> tuple[Probe, ...]:
        """The probes; along the way without those in program files, in which mutants may be waited for."""
        probes = self.job.vocabulary.probes
        if not along or self.returns is None:
            return probes
        modules = {probe: sys.modules.get(probe.target.partition(":")[0]) for probe in probes}
        files = {probe: getattr(module, "__file__", None) or "" for probe, module in modules.items()}
        return tuple(probe for probe in probes if not self.returns.is_program(files[probe]))

    def finish(self) -> None:
        """All tests are over: wait for branches, tell what was seen, and check the vocabulary if asked to."""
        if self.trunk is not None:
            self.trunk.finish()
        if self.texts is not None:
            self.texts.finish()
        if self.job.inspect:
            self.inspect_targets()
            self._tell_overrides()

    def _tell_overrides(self) -> None:
        """Say which calls went past an operation because another method overrides it."""
        for operation in self.job.vocabulary.operations:
            if sentences := self._watch.sentences(operation.target):
                self._remark(operation.source, "call", sentences)
            uncovered = self.interception.uncovered.get(operation.target) if operation.overrides else None
            if uncovered:
                self._remark(operation.source, "overrides", "; ".join(uncovered))

    def look_ahead(self) -> None:
        """The tests are about to begin: say what can be said about the targets that are there already."""
        if self.job.inspect:
            for operation in self.job.vocabulary.operations:
                self._check_arguments(operation)

    def inspect_targets(self) -> None:
        """Import what no test imported, so that every target of the vocabulary is looked at."""
        for target in sorted(self.interception.pending):
            module = target.partition(":")[0]
            try:
                importlib.import_module(module)
            except Exception as error:  # the user's module may fail in any way; say which and how
                self._tell(
                    self._source_of(target),
                    "call",
                    f"module {module!r} cannot be imported: {error!r}",
                    module,
                )
        for operation in self.job.vocabulary.operations:
            self._check_arguments(operation)
            self._check_current(operation)
        for tell in self._unfit.values():
            tell()
        self._check_idle()
        self._check_exceptions()
        for probe in self.job.vocabulary.probes:
            # what its objects have is not known to a class
            owner = self._look_up(probe.source, "call", probe.owner or probe.target)
            if owner is not None and probe.owner and not isinstance(owner, type):
                self._look_up(probe.source, "call", probe.target)

    def _check_idle(self) -> None:
        """Functions that make the answer of a command that is left out."""
        for operation in self.job.vocabulary.operations:
            for idle in (operation.idle, *(pattern.idle for pattern in operation.patterns)):
                call = idle.get("call") if isinstance(idle, dict) else None
                found = self._look_up(operation.source, "idle", call) if call is not None else None
                if found is not None and not callable(found):
                    self._tell(operation.source, "idle", f"{call} is {type(found).__name__}, not a function")

    def _check_exceptions(self) -> None:
        """A misspelt refusal would turn refusals into kills; so each name must be an exception."""
        vocabulary = self.job.vocabulary
        named = [
            (key, name) for key in ("refusals", "checks", "failures") for name in getattr(vocabulary, key)
        ]
        for key, name in named:
            self._check_exception("vocabulary", key, name)
        for operation in vocabulary.operations:
            for name in operation.refusals:
                self._check_exception(operation.source, "refusals", name)

    def _check_exception(self, source: str, key: str, name: str) -> None:
        found = self._look_up(source, f"{key} {name}", name)
        if found is not None and not (isinstance(found, type) and issubclass(found, BaseException)):
            self._tell(source, f"{key} {name}", f"{name} is no exception class")

    def _look_up(self, source: str, key: str, target: str) -> Any:
        """What a target names; None, and a problem, if there is no such thing."""
        module, _, qualname = target.partition(":")
        try:
            owner, name, _ = resolve(importlib.import_module(module), qualname)
            return getattr(owner, name)
        except NotFoundError as error:
            self._tell(source, key, str(error), error.name, error.known)
        except Exception as error:  # the user's module may fail in any way; say which and how
            self._tell(source, key, f"module {module!r} cannot be imported: {error!r}", module)
        return None

    def _handler(self, door: Door) -> Handler:
        def handle(
            wrapped: Callable[..., Any], instance: Any, args: tuple[Any, ...], kwargs: dict[str, Any]
        ) -> Any:
            __tracebackhide__ = True
            if self.meter is None:
                return wrapped(*args, **kwargs)
            if instance is not None and not self.instances.is_idle:
                self.instances.used(instance)
            if _under_way.get():
                return wrapped(*args, **kwargs)
            self.meter.count()
            located = self.locate(sys._getframe(1))
            if located is None:
                return wrapped(*args, **kwargs)
            if inspect.iscoroutinefunction(wrapped):
                return self._observe_async(door, located, wrapped, instance, args, kwargs)
            return self._observe(door, located, wrapped, instance, args, kwargs)

        return handle

    def _observe(
        self,
        door: Door,
        located: tuple[Span, Role],
        wrapped: Callable[..., Any],
        instance: Any,
        args: tuple[Any, ...],
        kwargs: dict[str, Any],
    ) -> Any:
        __tracebackhide__ = True
        token = _under_way.set(True)
        try:
            call = door.call(wrapped, instance, args, kwargs)
            reply: Reply | None = None
            try:
                mutated = self._mutant_for(located[0], call)
                if mutated is not None:
                    result, reply = mutated.run(door, call)
                    return result
                reply = door.reply(call, self._perform(door, call))
                return reply.payload
            finally:
                self._record(located, call, reply)
        finally:
            _under_way.reset(token)

    async def _observe_async(
        self,
        door: Door,
        located: tuple[Span, Role],
        wrapped: Callable[..., Any],
        instance: Any,
        args: tuple[Any, ...],
        kwargs: dict[str, Any],
    ) -> Any:
        __tracebackhide__ = True
        token = _under_way.set(True)
        try:
            call = door.call(wrapped, instance, args, kwargs)
            reply: Reply | None = None
            try:
                mutated = self._mutant_for(located[0], call)
                if mutated is not None:
                    result, reply = await mutated.run_async(door, call)
                    return result
                reply = door.reply(call, await self._perform_async(door, call))
                return reply.payload
            finally:
                self._record(located, call, reply)
        finally:
            _under_way.reset(token)

    def _mutant_for(self, span: Span, call: Call) -> Activation | None:
        if self.trunk is not None:
            self._let_branch(self.trunk, span, call)
        for activation in self.activations:
            if activation.is_here(span, call.operation.target) and activation.fits(call):
                return activation
        return None

    def _perform(self, door: Door, call: Call) -> Any:
        """Do what the program says."""
        __tracebackhide__ = True
        try:
            return door.perform(call, call)
        except BaseException as error:
            self._raised(error, call)
            raise

    async def _perform_async(self, door: Door, call: Call) -> Any:
        __tracebackhide__ = True
        try:
            return await door.perform(call, call)
        except BaseException as error:
            self._raised(error, call)
            raise

    def _raised(self, error: BaseException, call: Call) -> None:
        if self.texts is not None:
            self.texts.raised(error, call, self._refusals(call.operation))

    def _site_seen(self, site: SiteSeen) -> None:
        if self.branch is None:  # a branch sends its sites with its end
            self.pipe.send(site)

    def _let_branch(self, trunk: Trunk, span: Span, call: Call) -> None:
        """Fork for the mutants of this call; a branch goes on from here as its mutant."""
        pattern = call.pattern.text if call.pattern is not None else None
        self._become(trunk.branch(span, call.operation.target, pattern))

    def _branch_at_place(self, place: int, indexes: frozenset[int]) -> None:
        """The same for the mutants of a place in the program text that are these alternatives."""
        if self.trunk is not None:
            self._become(self.trunk.branch_at_place(place, indexes))

    def _become(self, mutant: Mutant | None) -> None:
        """In a branch that was just forked: take on its mutant."""
        if mutant is None or self.trunk is None:
            return
        choices = self.trunk.branching.choices.get(mutant.id, ())
        self.trunk, self.branch = None, mutant.id
        self.activate(mutant)
        self._start_activations()
        if self.texts is not None:
            self.texts.become(choices)

    def _record(self, located: tuple[Span, Role], call: Call, reply: Reply | None) -> None:
        span, role = located
        pattern = call.pattern.text if call.pattern is not None else None
        read = reply.values if reply is not None else {}
        is_wanted = self.recorder.answers is not None and reply is not None
        returned = Returned(reply.payload, here(call)) if reply is not None and is_wanted else None
        self.recorder.hit(span, role, call.operation.target, pattern, call.values, read, returned)
        if call.operation.command:
            self.along.after(len(self.recorder.trace))
        if self.job.inspect:
            self._fit.setdefault(call.operation.target, set()).update(read)
            instance = call.payload.instance
            self._askers[call.operation.target] = None if instance is None else type(instance)

    def _acted(self, part: str) -> None:
        """A part of the mutant changed something; the one of the program text has no name."""
        self._parts.add(part)
        if self.texts is not None and self.texts.is_mutant and not self.texts.has_acted:
            return
        if all(activation.mutant.id in self._parts for activation in self.activations):
            self.pipe.send(Acted(self.test, self.branch))

    def _in_mutated_call(self, began: bool) -> None:
        self.pipe.send(MutatedCall(self.test, began, self.branch))

    def _target_is_wrong(self, target: str, error: Exception) -> None:
        known = error.known if isinstance(error, NotFoundError) else ()
        name = error.name if isinstance(error, NotFoundError) else None
        self._tell(self._source_of(target), "call", str(error), name, known)

    def _path_is_wrong(self, operation: Operation, key: str, error: PathError) -> None:
        # only a path has names to choose from
        name = error.step if error.path else None

        def tell() -> None:
            if key.partition(".")[2] not in self._fit.get(operation.target, ()):
                self._tell(operation.source, key, str(error), name, error.known)

        if operation.message is not None or not key.startswith("result."):
            tell()
        elif self.job.inspect:  # one result may lack what others have
            self._unfit.setdefault((operation.source, key), tell)

    def _check_current(self, operation: Operation) -> None:
        if operation.current is None or operation.target not in self._askers:
            return
        try:
            why = why_not_asked(operation.current, self._askers[operation.target])
        except (NotFoundError, AttributeError, KeyError):  # it is told as an operation of its own
            return
        if why is not None:
            self._tell(operation.source, "current", why)

    def _check_arguments(self, operation: Operation) -> None:
        original = self.interception.found.get(operation.target)
        if original is None:
            return
        for found in look_at(operation, original):
            if found.is_remark:
                self._remark(operation.source, found.key, found.text)
            else:
                self._tell(operation.source, found.key, found.text, found.name, found.known)

    def _source_of(self, target: str) -> str:
        vocabulary = self.job.vocabulary
        operation = vocabulary.operation(target)
        if operation is not None:
            return operation.source
        if vocabulary.clock is not None and vocabulary.clock.tick == target:
            return vocabulary.clock.source
        return next((probe.source for probe in vocabulary.probes if probe.target == target), "")

    def _remark(self, source: str, key: str, text: str) -> None:
        if (source, key) not in self._told:
            self._told.add((source, key))
            self.pipe.send(Remark(source, key, text))

    def _tell(
        self, source: str, key: str, text: str, name: str | None = None, known: tuple[str, ...] = ()
    ) -> None:
        if (source, key) not in self._told:
            self._told.add((source, key))
            self.pipe.send(Problem(source, key, text, name, known))
