"""How a mutant becomes active in the processes of the tests, and where these first differ from the original.

A fork parent runs the original and forks a process for each mutant where that first differs: at a *key*.
Keys are tuples of plain values, since they are sent to other machines as well. The code that reaches a key
reports it: a call of an operation, a place of the program text, a moment of simulated time, the start of a
test. To all other code they are opaque.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mutabot.frozen import frozen
from mutabot.model.program_text import FATAL, IDENTITY

if TYPE_CHECKING:
    from mutabot.model.mutant import Place, Span

#: a point at which the process of a mutant first differs from the original's
Key = tuple[Any, ...]

CALL, TEXT, TIME, TEST, NTH = "call", "text", "time", "test", "nth"

#: the faults of the core, and what stands for the controls of all others
CALL_FAULT = "mutabot.runtime.interception.call_mutant:CallMutant"
TEXT_FAULT = "mutabot.runtime.program_text.text_mutant:TextMutant"
IDENTITY_CONTROL = "mutabot.runtime.active_fault:IdentityControl"
FATAL_CONTROL = "mutabot.runtime.active_fault:FatalControl"


class FatalFault(BaseException):
    """Raised by the fatal control. Not an ``Exception``, so that no program handles it by mistake."""


def at_text(place: int, index: int) -> Key:
    """Return the key of a place in the program text where this alternative may differ from the original."""
    return (TEXT, place, index)


def at_test(test: str) -> Key:
    """Return the key of the start of a test, before its fixtures."""
    return (TEST, test)


def of_kind(keys: Iterable[Key], kind: str) -> list[Key]:
    """Return the keys of this kind."""
    return [key for key in keys if key[0] == kind]


@frozen
class Activation:
    """How a mutant becomes active in a process of the tests.

    Class attributes:
        EACH_TEST: the key of the start of each test that reaches the mutant; ``at_time``, ``at_call`` and
            ``nth`` make others.
        AT_ONCE: awaits nothing: the fault is made before any module of the program is imported.
        FIRST_TEST: awaits the first test of the process.
        FIRST_TICK: awaits the clock's first tick.

    Attributes:
        reference: ``module:attribute`` of a ``mutabot.runtime.active_fault.ActiveFault``.
        data: what it gets as ``ActiveFault.data``; plain data, as JSON has it.
        keys: where a process with this mutant first differs from the original: a fork parent forks at the
            first of them that is reached. Empty: it cannot be forked, and runs in processes of its own.
        awaits: what must be there before the fault is made: ``AT_ONCE``, ``FIRST_TEST``, ``FIRST_TICK`` or
            the name of a module, which has then been imported. Processes below the tests await it likewise.
        identity, fatal: the controls at the place of the mutant; None for those that any fault has.
        is_of_tests: whether nothing is left of the fault after a test: only tests that reach it judge it.
    """

    EACH_TEST = (TEST,)
    AT_ONCE, FIRST_TEST, FIRST_TICK = "", "<test>", "<tick>"

    reference: str
    data: Any = None
    keys: tuple[Key, ...] = (EACH_TEST,)
    awaits: str = FIRST_TEST
    identity: Activation | None = None
    fatal: Activation | None = None
    is_of_tests: bool = False

    @staticmethod
    def at_time(seconds: float) -> Key:
        """Return the key of the first tick of a test at or after this simulated time, in seconds.

        The tick is one of the vocabulary's clock; a test's time begins with its first one.
        """
        return (TIME, seconds)

    @staticmethod
    def at_call(span: Span, operation: str, pattern: str | None = None) -> Key:
        """Return the key of a call of an operation, or of one of its text commands, at the span of a site."""
        place = span.line, span.column, span.end_line, span.end_column
        return (CALL, span.file, *place, operation, pattern)

    @staticmethod
    def nth(number: int, key: Key) -> Key:
        """Return the key of the n-th time that another key is reached in a test; ``number`` is n, from 1."""
        return (NTH, number, *key)

    @classmethod
    def of_call(cls, place: Place) -> Activation:
        """Return the activation of a mutant of the calls at a place."""
        key = cls.at_call(place.site.span, place.operation, place.pattern)
        own = cls(CALL_FAULT, keys=(key,), awaits=cls.AT_ONCE)
        return cls(CALL_FAULT, keys=(key,), awaits=cls.AT_ONCE, identity=own, fatal=own)

    @classmethod
    def of_text(cls, place: int, index: int) -> Activation:
        """Return the activation of an alternative, by its place's number and its index there."""
        own, identity, fatal = (
            cls(TEXT_FAULT, (place, number), (at_text(place, number),), cls.AT_ONCE)
            for number in (index, IDENTITY, FATAL)
        )
        return replace(own, identity=identity, fatal=fatal)

    def with_file(
        self, file: str, content: str, edit: tuple[int, int, str], tests: Iterable[str] | None
    ) -> Activation:
        """Return the activation of this alternative for tests that read its file, which then has it as well.

        Args:
            file: path of the program's file, relative to the project's root.
            content: what the file holds, in Latin-1; the same object for all alternatives of the file.
            edit: what stands where in it with the alternative: the first byte, the one after the last, and
                the text, in Latin-1.
            tests: tests before which nothing has read the file; None if something may have read it before
                any test, so that no process can be forked.
        """
        keys = () if tests is None else (*self.keys, *map(at_test, tests))
        # tests that read the file need not evaluate the place
        identity, fatal = Activation(IDENTITY_CONTROL), Activation(FATAL_CONTROL)
        data = (*self.data, file, content, edit)
        return replace(self, data=data, keys=keys, identity=identity, fatal=fatal)

    def control(self, *, is_fatal: bool = False) -> Activation:
        """Return the activation of the identity control at the same place, or of the fatal one."""
        own, reference = (self.fatal, FATAL_CONTROL) if is_fatal else (self.identity, IDENTITY_CONTROL)
        return own or Activation(reference, self.data, self.keys, self.awaits)

    @property
    def places(self) -> frozenset[int]:
        """The places of the program text at which it differs."""
        return frozenset(place for _, place, _ in of_kind(self.keys, TEXT))
