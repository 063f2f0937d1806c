"""Activation: one mutant at work at its site.

Answers that are the robot's own memory, as the arrays of a simulator: to write to one commands the robot.

A mutated reading is a copy. What the program writes to that is lost where the original would have taken it,
so such a run says nothing of the tests.
"""

from __future__ import annotations

import copy
import inspect
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from random import Random
from typing import Any

from mutabot.errors import OperatorError, PathError
from mutabot.model import Call, Middleware, Moment, Mutant, Operation, Proceed, Quantity, Reply, Role, Span
from mutabot.model.answer import restore
from mutabot.model.job import Idle
from mutabot.model.operation import Refused
from mutabot.model.path import Path, Step
from mutabot.operators import Need, Operator, Subject, operator
from mutabot.operators.command import FatalFault
from mutabot.operators.operator import subject_of
from mutabot.operators.passage import Carried, Passage, passed
from mutabot.runtime.evidence import REFUSALS, Evidence, leaves
from mutabot.runtime.interception import mishaps
from mutabot.runtime.interception.adapter import LOST, Door, here, snapshot
from mutabot.runtime.interception.arguments import held, kept_call, kept_reply
from mutabot.runtime.interception.refusals import answered, heard, is_told_on, refused_of
from mutabot.runtime.targets.target import is_named

#: copies that are looked at after each call
_LAST = 8
_MISSING = object()
#: values that nobody can write to
_FIXED = (int, float, complex, str, bytes, bool, type(None), frozenset, range)


def is_live(answer: Any, quantities: Iterable[Quantity]) -> bool:
    """Whether somebody else holds an answer, or a part of it that the vocabulary describes.

    To be asked as soon as the answer is there, by the one function that has it.
    """
    try:
        return _is_held(answer, _OF_ANSWER) or any(
            _is_held(part, _OF_PART) for quantity in quantities for part in _parts(answer, quantity.path)
        )
    except Exception:  # objects of the user's may do anything when they are looked at: then it may be
        return True


def _is_held(value: Any, known: int) -> bool:
    """``known``: the references to it that are no more than how one comes here."""
    if isinstance(value, (*_FIXED, tuple)):  # of a tuple, the parts may be written to
        return False
    if sys.getrefcount(value) > known:
        return True
    base = getattr(value, "base", None) if hasattr(value, "dtype") else None
    if base is None or not getattr(getattr(value, "flags", None), "writeable", True):
        return False
    # a view of an array that nobody else has is as good as that array
    return not hasattr(base, "dtype") or _is_held(base, _OF_ANSWER)


def _parts(answer: Any, path: Path) -> Iterator[Any]:
    """What lies on the way to a quantity, bar the answer itself and copies of parts of it."""
    value = answer
    for step in path.steps:
        if step.bounds is not None:
            return
        try:
            value = Path(None, (step,)).get(value)
        except PathError:
            return
        yield value


def _references(ask: Callable[[Any, int], bool], of_part: bool) -> int:
    """The most references that do not make a new list, or a new list in one, live."""
    known = 0
    while True:
        new: list[Any] = [[]] if of_part else []
        if not ask(new, known):
            return known
        known += 1


def _answer_is_held(answer: Any, known: int) -> bool:
    return _is_held(answer, known)


def _part_is_held(answer: Any, known: int) -> bool:
    return any(_is_held(part, known) for _ in (None,) for part in _parts(answer, _FIRST))


_FIRST = Path(None, (Step(item=0),))
# Counted and not written down, for what a call adds differs between versions of Python. Both functions have
# the shape of ``is_live``.
_OF_ANSWER = _references(_answer_is_held, of_part=False)
_OF_PART = _references(_part_is_held, of_part=True)


@dataclass(slots=True)
class _Handed:
    """A copy that the program was given, and what was in it."""

    value: Any
    before: Any


@dataclass(slots=True)
class HandedCopies:
    """Copies of live answers that the program has of a mutated reading.

    Attributes:
        written: whether it has written to one.
    """

    written: bool = False
    _handed: list[_Handed] = field(default_factory=list)

    def note(self, original: Any, handed: Any, quantities: Iterable[Quantity]) -> None:
        """The program gets ``handed`` in the place of a live answer."""
        pairs = [(original, handed)]
        for quantity in quantities:
            pairs += zip(_parts(original, quantity.path), _parts(handed, quantity.path), strict=False)
        known: set[int] = set()
        for before, after in pairs:
            if after is not before and id(after) not in known and not isinstance(after, (*_FIXED, tuple)):
                known.add(id(after))
                self._handed.append(_Handed(after, _content(after)))

    def look(self, *, at_all: bool = False) -> bool:
        """Whether the program has written to one by now; those that it has no more are forgotten.

        Without ``at_all`` only the last ones are looked at: a program may keep every reading that it takes.
        """
        start = 0 if at_all else max(0, len(self._handed) - _LAST)
        waiting = self._handed[start:]
        del self._handed[start:]
        while waiting and not self.written:
            one = waiting.pop(0)  # what it is a part of comes before a part, and goes before it
            self.written = not _is_as_before(one)
            if sys.getrefcount(one.value) > _IN_RECORD:
                self._handed.append(one)
        return self.written


def _of_new_record() -> int:
    one = _Handed([], [])
    return sys.getrefcount(one.value)


#: references to a value that nothing but such a record holds
_IN_RECORD = _of_new_record()


def _content(value: Any) -> Any:
    """What is in an object itself, to be compared later: what its parts hold is looked at by themselves."""
    if hasattr(value, "tobytes") and hasattr(value, "dtype"):
        return (str(value.dtype), value.tobytes())
    if isinstance(value, list | dict | set | bytearray) or hasattr(value, "typecode"):
        return copy.copy(value)
    own = getattr(value, "__dict__", None)
    if own is not None:
        return dict(own)
    return [getattr(value, name, None) for kind in type(value).__mro__ for name in _slots(kind)]


def _slots(kind: type) -> tuple[str, ...]:
    slots = kind.__dict__.get("__slots__", ())
    return (slots,) if isinstance(slots, str) else tuple(slots)


def _is_as_before(one: _Handed) -> bool:
    """Whether an object holds the same objects as before, or equal plain values."""
    before, now = one.before, _content(one.value)
    if isinstance(before, dict) and isinstance(now, dict):
        return all(
            _is_alike(before.get(key, _MISSING), now.get(key, _MISSING))
            for key in {**before, **now}
            if before.get(key) is not None or not _is_noted_by_itself(one.value, key)
        )
    if isinstance(before, list) and isinstance(now, list):
        return len(before) == len(now) and all(map(_is_alike, before, now))
    return _is_alike(before, now)


def _is_noted_by_itself(value: Any, key: Any) -> bool:
    """Whether an attribute that was not there yet is what an object remembers of its own: no write."""
    if isinstance(value, dict) or not isinstance(key, str):
        return False
    return key.startswith("_") or isinstance(getattr(type(value), key, None), cached_property)


def _is_alike(one: Any, other: Any) -> bool:
    if one is other:
        return True
    try:
        return type(one) is type(other) and bool(one == other or (one != one and other != other))  # noqa: PLR0124  # NaN
    except Exception:  # a value of the user's may compare in any way; it is another object
        return False


@dataclass(slots=True)
class Activation:
    """A mutant in place.

    Attributes:
        mutant: the mutant.
        operation: the operation it acts on.
        refusals: names of exceptions that are refusals.
        on_act: told when it changes something for the first time in a test.
        on_call: told when a mutated call begins (True) and when it has returned or raised (False).
        evidence: what it did in the running test.
        rule: its operator.
        watched: how the robot says that it refuses the last mutated call of the running test.
        time: simulated seconds since the test's first tick; None without a clock.
        usual: numbers of the calls of its site in the running test that the robot refuses in the original.
    """

    mutant: Mutant
    operation: Operation
    refusals: frozenset[str]
    on_act: Callable[[], None]
    on_call: Callable[[bool], None]
    evidence: Evidence = field(default_factory=Evidence)
    rule: Operator = field(init=False)
    watched: tuple[Refused, ...] = ()
    time: Callable[[], float | None] = lambda: None
    usual: frozenset[int] = frozenset()
    _told_by: tuple[Refused, ...] = ()
    _commands: int = 0
    _told: int = 0
    _is_passed: bool = False
    _middleware: Middleware | None = None
    _idle: Idle | None = None
    _moment: Moment | None = None
    _test: tuple[int, str] = (0, "")
    _early: Evidence = field(default_factory=Evidence)
    _handed: HandedCopies = field(default_factory=HandedCopies)
    _due: list[Deferred] = field(default_factory=list)
    _next: list[Deferred] = field(default_factory=list)

    def keep_early(self) -> None:
        """What it did before the first test counts in every test."""
        self._early = self.evidence

    def start(
        self,
        seed: int,
        round: int = 0,
        test: str = "",
        moment: Moment | None = None,
        usual: frozenset[int] = frozenset(),
    ) -> None:
        """A new test begins; the mutant's randomness follows from ``seed`` alone.

        Args:
            seed: of the mutant in this test.
            round, test: which.
            moment: at which calls of the test it acts; None for all.
            usual: numbers of the calls of its site that the robot refuses in the original too.
        """
        self.usual = usual
        self.evidence = replace(self._early, away=dict(self._early.away))
        self.rule = operator(self.mutant.operator)
        self._middleware = self.rule.middleware(self._subject(), Random(seed))
        self._idle = Idle.of(self.mutant.idle) if Need.IDLE in self.rule.needs else None
        self._test = (round, test)
        self._moment = moment
        self.watched = ()
        self._handed = HandedCopies()
        self._due, self._next = [], []

    def is_here(self, site: tuple[Span, Role], target: str) -> bool:
        """Whether calls of this operation at this place are the mutant's, bar the text command."""
        own = self.mutant.site
        return self.mutant.operation == target and (own.span, own.role) == site

    def fits(self, call: Call) -> bool:
        """Whether the call is the text command that the mutant is about."""
        return (call.pattern.text if call.pattern is not None else None) == self.mutant.pattern

    async def perform(self, door: Door, call: Call, is_async: bool, number: int) -> tuple[Any, Reply | None]:
        """Let the robot do what the mutant makes of a call.

        Args:
            door: its operation's.
            call: what the program says.
            is_async: whether what the operation returns is to be awaited; if not, nothing here suspends.
            number: of the call among those of its site in this test, from 1.

        Returns what the program receives, and the robot's last answer.
        """
        assert self._middleware is not None
        self.look_back()
        self.evidence.hits += 1
        passage = Passage(kept_call(call) if self._copies else call)
        is_due = self._moment is None or self._moment.holds(number, self.time())
        performer = _Performer(
            self, door, passage, is_async, does_nothing=is_due and self.rule.does_nothing, number=number
        )
        self._commands, self._told, self._is_passed = 0, 0, False
        middleware = self._middleware if is_due else _not_yet
        passage.call = replace(passage.call, is_refusal=partial(is_refusal, names=self.refusals))
        try:
            if self._idle is not None:
                passage.call = replace(passage.call, idle=self._answer(self._idle, door, call))
            reply = await passed(passage, _one_is_due if self._due else middleware, performer.proceed)
            reply = passage.received = mishaps.heard_of(passage.call, reply)
            self.note(passage)
            self._next += [Deferred(door, held(one), passage, is_async, number) for one in passage.deferred]
            last = passage.answered[-1] if passage.answered else None
            handed = mishaps.hand_over(passage.call, reply, partial(self._result, performer, last))
        except BaseException as error:
            if passage.received is None:
                self.note(passage)
            if isinstance(error, FatalFault):
                self.evidence.acted += 1
            elif performer.raised is None and self.evidence.failure is None:
                # neither the robot nor the program: the operator or the vocabulary is at fault
                self.evidence.failure = f"operator {self.mutant.operator}: {type(error).__name__}: {error}"
            raise
        return await handed(), last

    async def catch_up(self, is_async: bool) -> None:
        """A command of the program's is over: make the calls that were deferred until after it.

        One that must be awaited waits for a command that is awaited as well. Raises what the robot raises.
        """
        due = [one for one in self._due if is_async or not one.is_async]
        self._due = [one for one in self._due if one not in due] + self._next
        self._next = []
        for one in due:
            passage = Passage(one.passage.call, is_late=True)
            performer = _Performer(
                self, one.door, passage, one.is_async, does_nothing=False, number=one.number
            )
            passage.performed.append(one.call)
            try:
                await performer.proceed(one.call)
            finally:
                if not one.passage.acted_at_once:
                    self._acts(passage)

    def look_back(self, *, at_all: bool = False) -> None:
        """Look whether the program has written to what it got in the place of the robot's own memory."""
        if self._handed.look(at_all=at_all) and self.evidence.failure is None:
            self.evidence.failure = (
                f"the program writes to what {self.operation.name} returns, which is the robot's own memory; "
                "with the mutant it wrote to a copy, so the robot did not get it"
            )

    def _result(self, performer: _Performer, last: Reply | None, reply: Reply) -> Any:
        """What the program gets of a reply: the robot's own answer where nothing in it is changed."""
        call = performer.passage.call
        if performer.is_answered and reply.payload is performer.kept:
            reply = replace(reply, payload=performer.answer)
        result = performer.door.result(call, reply, original=last)
        if performer.is_live and result is not performer.answer:
            self._handed.note(performer.answer, result, (call.pattern or call.operation).result)
        return result

    @property
    def _copies(self) -> bool:
        return Need.COPIES in self.rule.needs

    def heard(self, name: str, message: Any) -> None:
        """A message came by, which may say that the robot refuses what it was told."""
        if not is_told_on(self._told_by, name):
            return
        self._told += 1
        if self.watched:
            self.refused_as(heard(self.watched, name, message))
            if self._is_passed and self._told >= self._commands:
                self.watched = ()

    def passed_by(self, call: Call) -> None:
        """Another call is made: if it is of the same command, what is refused from now on is that one.

        Unless the mutated call was several commands, and the robot has told of some: it will tell of the
        others first.
        """
        if self.watched and call.operation.target == self.operation.target:
            self._is_passed = True
            if not 0 < self._told < self._commands:
                self.watched = ()

    def count(self, call: Call) -> None:
        """The mutated call gives the robot one command more."""
        self._told_by = refused_of(call)
        self._commands += 1

    def refused_as(self, said: str | None) -> None:
        """How the robot refused a mutated call by data, in words; None if it did not."""
        if said is not None and self.evidence.said is None:
            self.evidence.said = said

    def _subject(self) -> Subject:
        mutant = self.mutant
        pattern = self.operation.pattern(mutant.pattern)
        found = subject_of(self.rule, self.operation, pattern, mutant.quantity, mutant.variant)
        if mutant.magnitude is None:
            return found
        return replace(  # a magnitude that is demanded need not be one of the operator's own
            found,
            variant=mutant.variant,
            magnitude=mutant.magnitude,
            unit=mutant.unit,
            direction=mutant.direction,
        )

    def _answer(self, idle: Idle, door: Door, call: Call) -> Reply:
        """What the command answers while the robot does nothing: what it answered here in the baseline.

        Where that changed from call to call it tells something about the world, which stands still now: so
        the robot's last answer in this test goes first, if it has given one.
        """
        if idle.is_varying(*self._test):
            last = door.last_answer(call)
            if last is not None:
                return last
        first = idle.first(*self._test)
        return Reply().never() if first == LOST else Reply({}, restore(first, here(call)))

    def note(self, passage: Passage) -> None:
        """What became of a call that is over, or of whose mutant this process dies."""
        if not passage.acted_at_once:
            if passage.away:
                self.evidence.away[passage.away] = self.evidence.away.get(passage.away, 0) + 1
            return
        self._acts(passage)

    def _acts(self, passage: Passage) -> None:
        if not self.evidence.acted:
            self.evidence.example = self._example(passage)
            self.on_act()
        self.evidence.acted += 1

    def _example(self, passage: Passage) -> tuple[Any, ...]:
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
    """A call that is not at the mutant's moment."""
    return await proceed(call.as_is("it is not the moment"))


async def _one_is_due(call: Call, proceed: Proceed) -> Reply:
    """A call that an earlier one waits for."""
    return await proceed(call.as_is("an earlier one is made after it"))


@dataclass(frozen=True, slots=True)
class Deferred:
    """A call that is made right after the program's next command.

    Attributes:
        door: its operation's.
        call: the call.
        passage: that of the call in which it was deferred.
        is_async: whether what it returns is to be awaited.
        number: of the call in whose place it is made, among those of its site.
    """

    door: Door
    call: Call
    passage: Passage
    is_async: bool
    number: int


@dataclass(slots=True)
class _Performer:
    """Performs calls for a passage, and notes how the robot took the mutated ones.

    A call that the robot refuses in the original too, by its ``number``, is left to the tests.

    Attributes:
        raised: what the robot raised.
        answer: what it returned last, and whether it has.
        kept: the same, or the copy that the operator saw.
        is_live: whether that is the robot's own memory.
    """

    activation: Activation
    door: Door
    passage: Passage
    is_async: bool
    does_nothing: bool
    number: int
    raised: BaseException | None = None
    answer: Any = None
    is_answered: bool = False
    kept: Any = None
    is_live: bool = False

    async def proceed(self, call: Call) -> Reply:
        if self.does_nothing:
            name = self.activation.mutant.operator
            text = f"operator {name} is to do nothing, but would have made the call"
            self.activation.evidence.failure = text
            raise OperatorError(text, operator=name)
        mutated = self.passage.changed_command
        self.activation.count(call)
        if mutated:
            self.activation.on_call(True)
            self.activation.watched = () if self._is_usual else refused_of(call)
        try:
            await mishaps.before(call, self._last_words)
            result = mishaps.timed(call, partial(self.door.perform, call, self.passage.call))()
            if self.is_async and inspect.isawaitable(result):
                result = await result
            await mishaps.after(call, result)
        except BaseException as error:
            self.raised = error
            self._judge(error)
            if isinstance(error, StopIteration):
                raise Carried(error) from None
            raise
        finally:
            if mutated:
                self.activation.on_call(False)
        if mutated and self.activation.watched:
            self.activation.refused_as(answered(call, result))
        meant = call.pattern or call.operation
        self.is_live = bool(meant.result) and is_live(result, meant.result)
        reply = self.door.reply(call, result)
        reply = kept_reply(reply) if self.activation._copies else reply
        self.answer, self.is_answered, self.kept = result, True, reply.payload
        return reply

    @property
    def _is_usual(self) -> bool:
        return self.number in self.activation.usual

    def _last_words(self) -> None:
        """This process is about to die of the mutant: tell what it did."""
        self.activation.note(self.passage)
        self.activation.on_call(False)
        self.activation.on_act()

    def _judge(self, error: BaseException) -> None:
        if not self.passage.changed_command:
            return
        evidence = self.activation.evidence
        if is_refusal(error, self.activation.refusals):
            if self._is_usual:
                return
            evidence.refusals = with_refusal(evidence.refusals, error)
        elif isinstance(error, TypeError) and _raised_at_the_call(error):
            evidence.invalid = True


def is_refusal(error: BaseException, names: Iterable[str]) -> bool:
    """Whether an operation raised a refusal, or a group of nothing else."""
    names = frozenset(names)
    return all(is_named(leaf, names) for leaf in leaves(error))


def with_refusal(refusals: tuple[BaseException, ...], error: BaseException) -> tuple[BaseException, ...]:
    """The refusals of a test with a new one; a program that tries on and on leaves no endless list."""
    return (*refusals, error)[-REFUSALS:]


def _raised_at_the_call(error: BaseException) -> bool:
    """Whether no code of the callable itself ran: its arguments did not fit."""
    traceback = error.__traceback__
    while traceback is not None and traceback.tb_next is not None:
        traceback = traceback.tb_next
    return traceback is not None and traceback.tb_frame.f_code is Door.perform.__code__
