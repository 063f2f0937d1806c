"""Guards, which are asked before each call of an operation and can keep it from the robot.

A guard sees the values that go out: they are read once more from the arguments that the operation is called
with, after everything that may have changed them. So it makes no difference which provider has a fault at
work, or whether the call is the program's, a test's or the library's own.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from importlib import import_module
from threading import get_ident
from typing import TYPE_CHECKING, Any, NoReturn

from mutabot.errors import ExtensionError, error_text

if TYPE_CHECKING:
    from mutabot.errors import PathError
    from mutabot.model import Call
    from mutabot.runtime.interception.adapter import Adapter, Invocation
    from mutabot.runtime.meter import Meter


class GuardedCall(BaseException):  # it is no error of the program's
    """A guard kept a call from the robot. Not an ``Exception``, so that no program handles it by mistake."""


class CallGuard(ABC):
    """The base class of guards, which decide which calls of operations must not reach the robot.

    It lives in each process of the tests.

    Args:
        table: the table of its name in the configuration, as plain data.
    """

    def __init__(self, table: Mapping[str, Any]) -> None:
        self.table = table

    def start_test(self) -> None:  # noqa: B027  # most guards remember nothing
        """Begin a test."""

    @abstractmethod
    def why_not(self, call: Call, unread: Mapping[str, str]) -> str | None:
        """Return why a call must not reach the robot, in a sentence; None if it may.

        Args:
            call: the call as the robot would get it, values in the units of their quantities. Its pattern is
                None if it is a text command that the vocabulary does not know.
            unread: why values of the call could not be read, by the keys of the vocabulary.
        """


@dataclass(slots=True)
class CallGuards:
    """The guards of this process.

    Attributes:
        guards: they are asked in this order.
        untracked: makes a context in which calls are none of the program's: a guard may read the robot.
        meter: gives what the running test has used; None between tests.
        targets: the operations of the vocabulary.
    """

    guards: tuple[CallGuard, ...]
    untracked: Callable[[], AbstractContextManager[None]]
    meter: Callable[[], Meter | None]
    targets: frozenset[str]

    @classmethod
    def load(cls, declared: Iterable[tuple[str, Mapping[str, Any]]], *parts: Any) -> CallGuards | None:
        """Return the guards that a job names; None if it names none. Raises ExtensionError."""
        made = tuple(_made(reference, table) for reference, table in declared)
        return cls(made, *parts) if made else None

    def start_test(self) -> None:
        """Begin a test for all guards."""
        for guard in self.guards:
            guard.start_test()

    def refuse(self, why: str) -> NoReturn:
        """Keep a call from the robot, and end the test."""
        meter = self.meter()
        if meter is not None:
            meter.guarded = meter.guarded or why
        raise GuardedCall(why)


@dataclass(slots=True)
class OperationGuard:
    """The check before each call of one operation.

    Attributes:
        guards: those of this process.
        reader: reads the values of its calls.
    """

    guards: CallGuards
    reader: Adapter
    #: what could not be read of the call at hand, by thread
    _unread: dict[int, dict[str, str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.reader.on_problem = self._note

    def check(self, invocation: Invocation) -> None:
        """Check a call before it is made. Raises GuardedCall if it must not be."""
        __tracebackhide__ = True
        why = self._why_not(invocation)
        if why is not None:
            self.guards.refuse(f"{self.reader.operation.target}: {why}")

    def check_opposite(self, target: str) -> None:
        """Check a call of the opposite operation, which may have no guard of its own."""
        if target not in self.guards.targets:
            self.guards.refuse(f"{target}: no guard can read it, since the vocabulary does not describe it")

    def _why_not(self, invocation: Invocation) -> str | None:
        unread = self._unread[get_ident()] = {}
        with self.guards.untracked():
            try:
                call = self.reader.to_call(invocation)
                found = (guard.why_not(call, unread) for guard in self.guards.guards)
                return next((why for why in found if why is not None), None)
            except Exception as error:  # what cannot say that a call is harmless does not let it pass
                return f"the guard fails: {error_text(error)}"
            finally:
                self._unread.pop(get_ident(), None)

    def _note(self, key: str, error: PathError) -> None:
        self._unread.setdefault(get_ident(), {}).setdefault(key, str(error))


def _made(reference: str, table: Mapping[str, Any]) -> CallGuard:
    module, _, name = reference.partition(":")
    made: Any = getattr(import_module(module), name)(table)
    if not isinstance(made, CallGuard):
        raise ExtensionError(f"{reference} is not a mutabot.api.processes.CallGuard")
    return made
