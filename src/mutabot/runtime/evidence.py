"""Evidence of a mutant at work, the exceptions that it causes, and the time of a test."""

from __future__ import annotations

import resource
import weakref
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.errors import MutabotError, error_text, text_of
from mutabot.extensions import brought
from mutabot.model.clocks import process_time
from mutabot.model.path import class_name

#: classes that are told by their names, since their modules may not be loaded, with what they hold
_WRAPPED, _SEVERAL = "doctest:UnexpectedException", "_pytest.doctest:MultipleDoctestFailures"


def leaves(error: BaseException) -> list[BaseException]:
    """Return the exceptions in a group, in order; the exception itself if it is no group."""
    held = _held(error)
    return [leaf for part in held for leaf in leaves(part)] if held else [error]


def everything(error: BaseException) -> Iterator[BaseException]:
    """Yield the exception, those in its group, and all their causes and contexts."""
    seen: set[int] = set()
    waiting = [error]
    while waiting:
        link = waiting.pop()
        if id(link) in seen:
            continue
        seen.add(id(link))
        yield link
        cause = _cause(link)
        waiting += [*_held(link), *([cause] if cause is not None else [])]


def failure_in(error: BaseException, failures: Iterable[str]) -> str | None:
    """Return the failure of the tool or the machine that an exception reports; None if it reports none.

    ``failures``: names of exceptions that the vocabulary says mean nothing else; packages name others.
    """
    from mutabot.runtime.targets.target import is_named  # noqa: PLC0415  # few exceptions are looked at

    failures = (*failures, *(part.reference for part in brought("failures").values()))
    for link in everything(error):
        if isinstance(link, MemoryError):
            return "the memory limit was reached"
        if isinstance(link, MutabotError) or is_named(link, failures):
            return error_text(link)
    return None


class KnownError:
    """Recognizes an exception without keeping it, or what its frames hold, alive.

    Most classes of Python's own cannot be referred to weakly. Of these, one that takes the place of another
    in memory and says the same is taken for it.
    """

    __slots__ = ("_address", "_reference", "_said")

    def __init__(self, error: BaseException) -> None:
        self._address = id(error)
        self._reference: weakref.ref[BaseException] | None = None
        try:
            self._reference = weakref.ref(error)
        except TypeError:
            self._said = (type(error), text_of(error))

    def matches(self, error: BaseException) -> bool:
        """Return whether this is the exception."""
        if self._reference is not None:
            return self._reference() is error
        return self._address == id(error) and self._said == (type(error), text_of(error))


class Refusal:
    """An exception by which the robot refused a mutated call.

    Attributes:
        text: what it said.
        noted: itself, and those that it held.
    """

    __slots__ = ("noted", "text")

    def __init__(self, error: BaseException) -> None:
        held = leaves(error)
        self.text = text_of(held[0])
        self.noted = tuple(
            KnownError(held_error) for held_error in (error, *(leaf for leaf in held if leaf is not error))
        )


def is_due_to(error: BaseException, culprits: Sequence[KnownError]) -> bool:
    """Return whether an exception is one of the culprits, or was caused by them alone.

    A group is so if all that it holds are, or if it was made of one: with ``raise … from``, or while a
    culprit was handled. What a group was raised beside says nothing otherwise: a task group ends beside
    the cancellation of its body.
    """
    return _is_due(error, culprits, frozenset())


def _is_due(error: BaseException | None, culprits: Sequence[KnownError], above: frozenset[int]) -> bool:
    """Return whether an exception is due to culprits; ``above`` has those on the way, against circles."""
    if error is None or id(error) in above:
        return False
    if any(culprit.matches(error) for culprit in culprits):
        return True
    above |= {id(error)}
    held = _held(error)
    if not held:
        return _is_due(_cause(error), culprits, above)
    if all(_is_due(part, culprits, above) for part in held) or _is_due(error.__cause__, culprits, above):
        return True
    cause = _cause(error)
    is_known = cause is not None and any(culprit.matches(cause) for culprit in culprits)
    return is_known and all(cause is not leaf for leaf in leaves(error))


def _held(error: BaseException) -> tuple[BaseException, ...]:
    if isinstance(error, BaseExceptionGroup):
        return error.exceptions
    names = {class_name(kind) for kind in type(error).__mro__}
    if _WRAPPED in names:
        return (error.exc_info[1],)  # type: ignore[attr-defined]  # see above
    return tuple(error.failures) if _SEVERAL in names else ()  # type: ignore[attr-defined]


def _cause(error: BaseException) -> BaseException | None:
    return error.__cause__ or (None if error.__suppress_context__ else error.__context__)


#: refusals of one test that are kept
REFUSALS = 16


@dataclass(slots=True)
class Evidence:
    """What a mutant did in the running test.

    Attributes:
        hits: calls at its site.
        acted: hits at which it changed something.
        example: value before and after, at the first hit at which it acted.
        refusals: how the robot refused mutated calls by exceptions, the latest last; not all of many.
        refusing_answer: the answer by which the robot refused a mutated call; None if there was none.
        failure: what went wrong in the tool or the operator itself, or None.
        is_of_text: whether the mutant is one of the program text, which makes no calls itself: a refusal
            then counts only if it ends the test.
        is_unknown: whether what the robot refused is no command at all.
        away: hits at which it stayed away, by the reason, as far as the operator says.
    """

    hits: int = 0
    acted: int = 0
    example: tuple[Any, ...] | None = None
    refusals: tuple[Refusal, ...] = ()
    refusing_answer: str | None = None
    failure: str | None = None
    is_of_text: bool = False
    is_unknown: bool = False
    away: dict[str, int] = field(default_factory=dict)

    def copy(self) -> Evidence:
        """Return an independent copy of the evidence."""
        return replace(self, away=dict(self.away))

    @property
    def culprits(self) -> tuple[KnownError, ...]:
        """The refusals and all exceptions in them."""
        return tuple(error for refusal in self.refusals for error in refusal.noted)

    @property
    def refusal(self) -> str | None:
        """The robot's text of refusing a mutated call; None if it refused none."""
        return self.refusals[-1].text if self.refusals else self.refusing_answer


class TimeExceeded(BaseException):  # it is no error of the program's
    """A test took too much simulated time. Not an ``Exception``, so that no program handles it by mistake."""


@dataclass(slots=True)
class Meter:
    """A meter of what the running test has used so far.

    Attributes:
        limit: seconds of simulated time that it may take; None for any.
        spare: seconds of processor time within which it has not exceeded that: a loop whose end is near may
            ask a simulated clock many times in a moment.
        operations: intercepted calls so far.
        started, now: simulated time at the test's first tick and at its last one, s; None before.
        used: simulated time that earlier clocks of the same test counted, s.
        exceeded: the limit that was exceeded, in words.
        guarded: which command a guard kept from the robot, and why; None if none did.
        began: processor time of this process when it began with the test, s.
    """

    limit: float | None = None
    spare: float = 0.0
    operations: int = 0
    started: float | None = None
    now: float | None = None
    used: float = 0.0
    exceeded: str | None = None
    guarded: str | None = None
    began: float = field(default_factory=process_time)

    def continue_in_copy(self) -> None:
        """Restart the count of processor time in a process that was just forked."""
        self.began = process_time()

    def tick(self, time: float) -> None:
        """Set simulated time to ``time`` (s). Raises TimeExceeded beyond the limit."""
        if self.started is None or self.now is None:
            self.started = time
        elif time < self.now:  # a new simulation began in the same test
            self.used += self.now - self.started
            self.started = time
        self._reach(time)

    def advance(self, seconds: float) -> None:
        """Advance simulated time by some seconds. Raises TimeExceeded beyond the limit."""
        if self.started is None or self.now is None:
            self.started = self.now = 0.0
        self._reach(self.now + seconds)

    def _reach(self, time: float) -> None:
        self.now = time
        if self.limit is not None and (self.simulated or 0.0) > self.limit:
            self._exceed(self.limit)

    @property
    def simulated(self) -> float | None:
        """Simulated seconds so far; None without a clock."""
        if self.started is None or self.now is None:
            return None
        return self.used + self.now - self.started

    def _exceed(self, limit: float) -> None:
        if process_time() - self.began > self.spare:
            self.exceeded = self.exceeded or f"more than {limit:.6g} s of simulated time"
            raise TimeExceeded(self.exceeded)


def limit_memory(limit: int) -> None:
    """Let allocations beyond ``limit`` bytes of address space fail in this process."""
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    allowed = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
    resource.setrlimit(resource.RLIMIT_AS, (allowed, hard))
