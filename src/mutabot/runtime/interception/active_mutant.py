"""Apply one mutant at its site, and recognise calls that the robot refuses."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from functools import partial
from random import Random
from traceback import walk_tb
from typing import Any

from mutabot.errors import OperatorError, PathError, error_text
from mutabot.languages.registry import front_end_of
from mutabot.model import Call, Middleware, Moment, Mutant, Operation, Proceed, Reply, Span
from mutabot.model.activation import FatalFault
from mutabot.model.answer import restore
from mutabot.model.data import UNKNOWN, data_of, is_of_numpy
from mutabot.model.enumeration import is_member, member_of
from mutabot.model.job import Idle, RefusedAt
from mutabot.model.mutant import Extent
from mutabot.model.operation import Form, Refused
from mutabot.operators import Need, Subject, operator
from mutabot.operators.middleware import CallRecord, Carried, run_middleware
from mutabot.operators.operator import subject_of
from mutabot.runtime.activity import REFUSALS, Activity
from mutabot.runtime.exceptions import KnownError, Refusal, leaves
from mutabot.runtime.interception import call_faults
from mutabot.runtime.interception.adapter import Adapter, SiteCall, call_context, snapshot
from mutabot.runtime.interception.live import HandedCopies, copied, is_live
from mutabot.runtime.interception.trace import LOST
from mutabot.runtime.targets.target import CallPlace, is_named

#: exceptions by which others end what an operator does: a user, an event loop, the end of a generator
_FROM_OUTSIDE = frozenset({"KeyboardInterrupt", "CancelledError", "Cancelled", "GeneratorExit"})
#: frames that carry out a call: an operator that calls itself without end has more
_DEPTH = 100
#: the name of a site: file, function, text and occurrence, which stay where the text around it changes
_SiteName = tuple[str, str, str, int]
#: the calls of a test at a site: where it is, the operation and the pattern
_CallKey = tuple[Span | _SiteName, str, str | None]


@dataclass(slots=True)
class RefusedCalls:
    """The calls of the running test that the robot refuses in the original.

    The baseline notes them. In all other runs they are known from it: a mutated call that is refused there
    as well shows nothing but what the original shows.

    Attributes:
        on_refused: called for each refusal in the baseline; None in all other runs.
        changed: files of the program that are others in this process: sites are known by their names there.
    """

    on_refused: Callable[[SiteCall], None] | None = None
    changed: dict[str, bytes] = field(default_factory=dict)
    _known: dict[_CallKey, frozenset[int]] = field(default_factory=dict)
    _watched: dict[str, tuple[SiteCall, tuple[Refused, ...]]] = field(default_factory=dict)

    def start(self, known: Iterable[RefusedAt]) -> None:
        """Begin a test with these known refusals."""
        self._known = {
            (where, refusal.operation, refusal.pattern): frozenset(refusal.numbers)
            for refusal in known
            for where in (
                refusal.site.span,
                _name(refusal.site.span, refusal.site.text, refusal.site.occurrence),
            )
        }
        self._watched.clear()

    def at(self, span: Span, operation: str, pattern: str | None) -> frozenset[int]:
        """Return the numbers of the refused calls of a site."""
        return self._known.get((span, operation, pattern), frozenset())

    def has(self, made: SiteCall) -> bool:
        """Return whether this call is a known refusal of the original."""
        pattern = made.call.pattern.text if made.call.pattern is not None else None
        span = made.site[0]
        where = self._name_of(span) if span.file in self.changed else span
        return made.number in self._known.get((where, made.call.operation.target, pattern), ())

    def _name_of(self, span: Span) -> _SiteName:
        front_end, names = front_end_of(span.file), dict[Extent, tuple[str, int]]()
        with suppress(SyntaxError, ValueError):
            names |= front_end.names(front_end.text_of(self.changed[span.file]))
        return _name(span, *names.get((span.line, span.column, span.end_line, span.end_column), ("", 0)))

    def begins(self, made: SiteCall) -> None:
        """Note a call of the original, to which refusals from now on belong."""
        if self.on_refused is None:
            return
        self._watched.pop(made.call.operation.target, None)
        refused = possible_refusals(made.call)
        if any(refusal.topic is not None for refusal in refused):
            call = Call(made.call.operation, made.call.pattern)  # nothing of the program's is kept
            self._watched[made.call.operation.target] = (replace(made, call=call), refused)

    def returned(self, made: SiteCall, result: Any) -> None:
        """Check whether the answer to a call of the original shows that the robot refuses it."""
        if self.on_refused is not None and answered(made.call, result) is not None:
            self.on_refused(made)

    def heard(self, name: str, message: Any) -> None:
        """Check whether a message shows that the robot refuses a call of the original."""
        for target, (made, refused) in list(self._watched.items()):
            if self.on_refused is not None and heard(refused, name, message) is not None:
                del self._watched[target]
                self.on_refused(made)


def _name(span: Span, text: str, occurrence: int) -> _SiteName:
    return span.file, span.function, text, occurrence


def possible_refusals(call: Call) -> tuple[Refused, ...]:
    """Return the ways in which the robot can refuse this command."""
    own = call.pattern.refused if call.pattern is not None else ()
    return own or call.operation.refused


def answered(call: Call, result: Any) -> str | None:
    """Return the text with which the answer to a command refuses it; None if it does not."""
    for refused in possible_refusals(call):
        if refused.topic is None:
            found = _found(refused, result)
            if found is not None:
                return f"answered {found}"
        elif _is_rejected(call, result) and "REJECTED" in refused.values:
            return f"{refused.topic}: REJECTED"
    return None


def heard(refused: Iterable[Refused], name: str, message: Any) -> str | None:
    """Return the text with which a message of this name refuses a command; None if it does not.

    Of an action, messages are its results, and the words by which its goals end.
    """
    for refusal in refused:
        if refusal.topic is not None and fnmatchcase(name, refusal.topic):
            found = _found(refusal, message)
            if found is not None:
                return f"{name}: {found}"
    return None


def _is_rejected(call: Call, result: Any) -> bool:
    named = call.operation.named
    return named is not None and named.form is Form.GOAL and getattr(result, "accepted", None) is False


def _found(refused: Refused, start: Any) -> str | None:
    path = refused.parsed
    try:
        value = path.get(start)
    except PathError:  # another kind of answer, or of message
        return None
    value = data_of(value)
    value = value.tolist() if is_of_numpy(value) else value
    if value is UNKNOWN or not any(_means(wanted, value) for wanted in refused.values):
        return None
    value = value.value if is_member(value) else value
    return " ".join(part for part in (str(path).lstrip("."), str(value)) if part)


def _means(wanted: Any, value: Any) -> bool:
    """Return whether a value of the vocabulary denotes one of the robot's, such as a member of an enum."""
    if not is_member(value):
        return _same(value, wanted)
    member = member_of(type(value), wanted)
    return member is not None and bool(member == value)


def _same(value: Any, wanted: Any) -> bool:
    """Return whether both are equal; a truth value is no number."""
    try:
        return isinstance(value, bool) is isinstance(wanted, bool) and bool(value == wanted)
    except Exception:  # a value of the user's may compare in any way
        return False


@dataclass
class MutatedSite:
    """An active mutant of calls.

    Attributes:
        mutant: the mutant.
        operation: the operation it acts on.
        refusals: names of exceptions that are refusals.
        on_act: called when it changes something for the first time in a test.
        on_call: called when a mutated call begins (True) and when it has returned or raised (False).
        time: returns simulated seconds since the test's first tick; None without a clock.
        activity: what it did in the running test.
        rule: its operator.
        watched: how the robot says that it refuses the last mutated call of the running test.
        usual: numbers of the calls of its site in the running test that the robot refuses in the original.
        copies: whether its operator remembers calls and replies, so that it needs copies.
        early: what it did before the first test, which counts in every test.
    """

    mutant: Mutant
    operation: Operation
    refusals: frozenset[str]
    on_act: Callable[[], None]
    on_call: Callable[[bool], None]
    time: Callable[[], float | None] = lambda: None

    def __post_init__(self) -> None:
        self.activity, self.early = Activity(), Activity()
        self._refusals: tuple[Refused, ...] = ()
        self._commands, self._reported, self._is_passed = 0, 0, False
        self._forget()

    def _forget(self) -> None:
        """Reset what belongs to one test."""
        self.watched: tuple[Refused, ...] = ()
        self._handed: HandedCopies | None = None
        self._due: list[tuple[int, _MutatedCall, Call]] = []

    def start(self, seed: int, round: int, test: str, moment: Moment | None, usual: frozenset[int]) -> None:
        """Begin a new test; the mutant's randomness follows from ``seed`` alone.

        Args:
            seed: of the mutant in this test.
            round, test: which.
            moment: at which calls of the test it acts; None for all.
            usual: numbers of the calls of its site that the robot refuses in the original too.
        """
        self.usual = usual
        self.activity = self.early.copy()
        self._test = (round, test)
        self._moment = moment
        self._forget()
        try:
            self._make_ready(seed)
        except BaseException as error:  # the operator's code may fail in any way: here no program meets it
            if type(error).__name__ in _FROM_OUTSIDE:
                raise
            self._fails(error, " cannot be made ready")

    def _make_ready(self, seed: int) -> None:
        self._middleware: Middleware = _not_yet
        self._does_nothing, self._idle, self.copies = False, None, False
        self.rule = operator(self.mutant.operator)
        self.copies = Need.COPIES in self.rule.needs
        self._middleware = self.rule.middleware(self._subject(), Random(seed))
        self._idle = Idle.of(self.mutant.idle) if Need.IDLE in self.rule.needs else None
        self._does_nothing = self.rule.does_nothing

    def _fails(self, error: BaseException, how: str = "") -> None:
        """Report that the operator or the vocabulary failed, not the robot or the program."""
        text = f"operator {self.mutant.operator}{how}: {error_text(error)}"
        self.activity.failure = self.activity.failure or text

    def is_here(self, site: CallPlace, call: Call) -> bool:
        """Return whether the mutant acts at this place and on this operation and text command."""
        own = self.mutant.site
        pattern = call.pattern.text if call.pattern is not None else None
        is_own = self.mutant.operation == call.operation.target and self.mutant.pattern == pattern
        return is_own and (own.span, own.role) == site

    async def apply(self, adapter: Adapter, made: SiteCall) -> tuple[Any, Reply | None]:
        """Make a call as the mutant changes it, and return its result and the reply.

        Unless the operation is async, nothing here suspends. Returns what the program receives, and the
        robot's last answer.
        """
        self.look_back()
        hit = self.activity.hits = self.activity.hits + 1
        call = replace(made.call, payload=made.call.payload.copied()) if self.copies else made.call
        is_due = self._moment is None or self._moment.holds(made.number, self.time())
        if self.mutant.by_number:
            call = replace(
                call, operation=self.operation, pattern=self.operation.pattern(self.mutant.pattern)
            )
        passage = CallRecord(call)
        mutated = _MutatedCall(self, adapter, made, passage, does_nothing=is_due and self._does_nothing)
        self._commands, self._reported, self._is_passed = 0, 0, False
        middleware = _one_is_due if self._due else self._middleware if is_due else _not_yet
        try:
            known: dict[str, Any] = {"is_refusal": partial(is_refusal, names=self.refusals)}
            if self._idle is not None:
                known["idle"] = self._idle_answer(self._idle, adapter, made.call)
            reply = await run_middleware(passage, middleware, mutated.proceed, **known)
            if reply.more:
                reply = passage.received = call_faults.received_part(passage.call, reply)
            self.note(passage)
            self._due += [(hit, mutated, _held(deferred)) for deferred in passage.deferred]
            last = passage.answered[-1] if passage.answered else None
            if reply.comes_as_usual:
                return mutated.result(last, reply), last
            handed = call_faults.hand_over(passage.call, reply, partial(mutated.result, last))
        except BaseException as error:
            if passage.received is None:
                self.note(passage)
            if isinstance(error, FatalFault):
                self._count_act()
            elif mutated.is_own(error):
                self._fails(error)
            raise
        finally:
            self.activity.asked |= adapter.asks > 0
        return await handed(), last

    async def catch_up(self, is_async: bool, hits: int) -> None:
        """Make the calls that were deferred until after a command of the program, which is over.

        One that must be awaited waits for a command that is awaited as well, and one from within the command
        for the next: ``hits`` had been when it began. Raises what the robot raises.
        """
        if not self._due:
            return
        due = [late for late in self._due if late[0] <= hits and (is_async or not late[1].made.is_async)]
        self._due = [late for late in self._due if late not in due]
        for _, mutated, call in due:
            late = replace(mutated, passage=CallRecord(mutated.passage.call, is_late=True))
            late.passage.begins(call)
            late.does_nothing = False
            try:
                await late.proceed(call)
            finally:
                if not mutated.passage.acted_at_once:
                    self._acts(late.passage)

    def look_back(self, *, at_all: bool = False) -> None:
        """Check whether the program has written to a copy that it got instead of the robot's own memory."""
        if self._handed is None or self.activity.failure is not None:
            return
        if self._handed.look(at_all=at_all):
            self.activity.failure = (
                f"the program writes to what {self.operation.name} returns, which is the robot's own memory; "
                "with the mutant it wrote to a copy, so the robot did not get it"
            )

    def hands(self, call: Call, answer: Any, result: Any) -> None:
        """Note that the program gets ``result`` in the place of a live answer."""
        self._handed = self._handed or HandedCopies()
        self._handed.note(answer, result, (call.pattern or call.operation).result)

    def heard(self, name: str, message: Any) -> None:
        """Check whether a message says that the robot refuses a command."""
        if not any(
            refusal.topic is not None and fnmatchcase(name, refusal.topic) for refusal in self._refusals
        ):
            return
        self._reported += 1
        if self.watched:
            self.refused_as(heard(self.watched, name, message))
            if self._is_passed and self._reported >= self._commands:
                self.watched = ()

    def passed_by(self, call: Call) -> None:
        """Note another call; if it is the same command, refusals from now on belong to it.

        Unless the mutated call was several commands, and the robot has reported some: it will report the
        others first.
        """
        if self.watched and call.operation.target == self.operation.target:
            self._is_passed = True
            if not 0 < self._reported < self._commands:
                self.watched = ()

    def count(self, call: Call) -> None:
        """Count one more command that the mutated call gives to the robot."""
        self._refusals = possible_refusals(call)
        self._commands += 1

    def refused_as(self, text: str | None) -> None:
        """Note the text with which the robot refused a mutated call; None if it did not."""
        if text is not None and self.activity.refusing_answer is None:
            self.activity.refusing_answer = text

    def _subject(self) -> Subject:
        mutant = self.mutant
        pattern = self.operation.pattern(mutant.pattern)
        found = subject_of(self.rule, self.operation, pattern, mutant.quantity, mutant.variant)
        if mutant.magnitude is None:
            return found
        # a magnitude that is demanded need not be one of the operator's own
        magnitude, unit = mutant.magnitude, mutant.unit
        found = replace(found, magnitude=magnitude, unit=unit, direction=mutant.direction)
        return replace(found, variant=mutant.variant)

    def _idle_answer(self, idle: Idle, adapter: Adapter, call: Call) -> Reply:
        """Return the command's answer if the robot does nothing, as recorded in the baseline.

        Where that changed from call to call it is information about the world, which stands still now: so
        the robot's last answer in this test goes first, if it has given one.
        """
        if idle.is_varying(*self._test):
            last = adapter.last_answer(call)
            if last is not None:
                return last
        first = idle.first(*self._test)
        return Reply().never() if first == LOST else Reply({}, restore(first, call_context(call)))

    def note(self, passage: CallRecord) -> None:
        """Note the record of a call that is over, or that ends this process."""
        if passage.acted_at_once:
            self._acts(passage)
        elif passage.away:
            self.activity.away[passage.away] = self.activity.away.get(passage.away, 0) + 1

    def _acts(self, passage: CallRecord) -> None:
        if not self.activity.acted:
            self.activity.example = self._example(passage)
        self._count_act()

    def _count_act(self) -> None:
        self.activity.acted += 1
        if self.activity.acted == 1:
            self.on_act()

    def _example(self, passage: CallRecord) -> tuple[Any, ...]:
        name = self.mutant.quantity
        if name is None:
            return (dict(passage.call.values), [dict(call.values) for call in passage.performed])
        if passage.changed_command:
            after = passage.performed[0].values.get(name) if passage.performed else None
            return (snapshot(passage.call.values.get(name)), snapshot(after))
        reply = passage.received
        received = reply.values.get(name) if reply is not None else None
        if reply is not None and reply.error:
            received = f"raises {reply.error}"
        return (snapshot(passage.answered[-1].values.get(name)), snapshot(received))


async def _not_yet(call: Call, proceed: Proceed) -> Reply:
    """Leave alone a call that is not at the mutant's moment."""
    return await proceed(call.as_is("it is not the moment"))


async def _one_is_due(call: Call, proceed: Proceed) -> Reply:
    """Pass on, unchanged, a call after which a deferred one is made."""
    return await proceed(call.as_is("an earlier one is made after it"))


def _held(call: Call) -> Call:
    """Return a call that is made later, with copies of its described arguments.

    The program may use a pose again for the next call; an argument that is no data is the same object then. A
    message is data.
    """
    names = call.operation.described if call.operation.named is None else None
    return replace(call, payload=call.payload.copied(names))


@dataclass(slots=True)
class _MutatedCall:
    """A call at the mutant's site: performs what the operator makes of it, and notes the robot's reaction.

    Attributes:
        does_nothing: whether the operator is to let the robot do nothing.
        raised: what the robot raised, all of it; it is not kept, since its traceback leads here.
        answer: what it returned last, and whether it has.
        kept: the same, or the copy that the operator saw.
        is_live: whether that is the robot's own memory.
    """

    mutant: MutatedSite
    adapter: Adapter
    made: SiteCall
    passage: CallRecord
    does_nothing: bool
    raised: list[KnownError] = field(default_factory=list)
    answer: Any = None
    is_answered: bool = False
    kept: Any = None
    is_live: bool = False

    async def proceed(self, call: Call) -> Reply:
        mutant = self.mutant
        if self.does_nothing:
            name = mutant.mutant.operator
            mutant.activity.failure = f"operator {name} is to do nothing, but would have made the call"
            raise OperatorError(mutant.activity.failure)
        is_changed = self.passage.changed_command
        mutant.count(call)
        if is_changed:
            mutant.on_call(True)
            mutant.watched = () if self._is_usual else possible_refusals(call)
        try:
            result = await self._perform(call)
        except BaseException as error:
            raised = error.error if isinstance(error, Carried) else error
            self.raised.append(KnownError(raised))
            if is_changed and is_refusal(raised, mutant.refusals) and not self._is_usual:
                mutant.activity.refusals = with_refusal(mutant.activity.refusals, raised)
            del raised
            raise
        finally:
            if is_changed:
                mutant.on_call(False)
        if is_changed and mutant.watched:
            mutant.refused_as(answered(call, result))
        meant = call.pattern or call.operation
        self.is_live = bool(meant.result) and is_live(result, meant.result)
        reply = self.adapter.to_reply(call, result)
        reply = replace(reply, payload=copied(reply.payload)) if mutant.copies else reply
        self.answer, self.is_answered, self.kept = result, True, reply.payload
        return reply

    def is_own(self, error: BaseException) -> bool:
        """Return whether an exception is the operator's own, not the robot's, pytest's or an event loop's."""
        error = error.error if isinstance(error, Carried) else error
        if any(known.matches(error) for known in self.raised):
            return False
        if isinstance(error, RecursionError):  # it may be the program's, which we have made deeper by little
            return len([*walk_tb(error.__traceback__)]) > _DEPTH
        if isinstance(error, Exception):
            return True
        if type(error).__name__ in _FROM_OUTSIDE:
            return False
        own = {kind.__module__ for kind in type(self.mutant.rule).__mro__}
        return any(frame.f_globals.get("__name__") in own for frame, _ in walk_tb(error.__traceback__))

    async def _perform(self, call: Call) -> Any:
        is_own = call is self.passage.call
        action = partial(self.adapter.perform, call, None if is_own else self.passage.changes)
        try:
            if call.call_faults:
                await call_faults.before(call, self._report_before_death)
            result = call_faults.perform(call, action) if call.call_faults else action()
            if self.made.is_async and inspect.isawaitable(result):
                result = await result
        except StopIteration as error:
            raise Carried(error) from None
        if call.call_faults:
            await call_faults.after(call, result)
        return result

    def result(self, last: Reply | None, reply: Reply) -> Any:
        """Return the program's result for a reply: the robot's own answer if nothing in it is changed."""
        call = self.passage.call
        if self.is_answered and reply.payload is self.kept:
            reply = replace(reply, payload=self.answer)
        result = self.adapter.to_result(call, reply, original=last)
        if self.is_live and result is not self.answer:
            self.mutant.hands(call, self.answer, result)
        return result

    @property
    def _is_usual(self) -> bool:
        """Whether the robot refuses this call in the original too, so that the tests judge it."""
        return self.made.number in self.mutant.usual

    def _report_before_death(self) -> None:
        """Report what the mutant did, as this process is about to end because of it."""
        self.mutant.note(self.passage)
        self.mutant.on_call(False)
        self.mutant.on_act()


def is_refusal(error: BaseException, names: Iterable[str]) -> bool:
    """Return whether an operation raised a refusal, or a group of nothing else."""
    names = frozenset(names)
    return all(is_named(leaf, names) for leaf in leaves(error))


def with_refusal(refusals: tuple[Refusal, ...], error: BaseException) -> tuple[Refusal, ...]:
    """Append a refusal to those of a test, keeping only the last ones if a program retries for ever."""
    return (*refusals, Refusal(error))[-REFUSALS:]
