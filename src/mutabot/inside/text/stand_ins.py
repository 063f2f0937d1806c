"""What stood in for the robot in the tests, and which calls of an operation's name were left alone."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

from mutabot.inside.targets.target import Finding
from mutabot.model import ANY, Operation, Role, Span
from mutabot.model.class_name import class_name

from .call_sites import NOTHING, CallSite

#: calls that are listed in one sentence
_MOST = 5


@dataclass(slots=True)
class StandIns:
    """What stood at sites, for who checks a vocabulary.

    Args:
        test: tells the running test.
        relative: tells a path below the root.
    """

    test: Callable[[], str]
    relative: Callable[[str], str]
    _standing: dict[str, dict[str, set[str]]] = field(default_factory=dict)
    _alone: dict[str, dict[str, str]] = field(default_factory=dict)
    _sites: set[CallSite] = field(default_factory=set)
    _elsewhere: dict[str, set[str]] = field(default_factory=dict)

    def note(self, site: CallSite, operation: Operation | None, found: Any, receiver: Any) -> None:
        """This was called at a site, as this operation or as none."""
        what = _shown(found, receiver)
        if operation is not None:
            self._sites.add(site)
            self._standing.setdefault(operation.target, {}).setdefault(what, set()).add(self.test())
        elif site.role is Role.PROGRAM and site not in self._sites:
            place = f"{self.relative(site.path)}:{site.extent[0]}"
            self._alone.setdefault(site.name, {})[place] = what

    def note_elsewhere(self, operation: Operation, place: tuple[Span, Role] | None) -> None:
        """This was called where a frame may tell the place, or nothing does."""
        if place is None:
            self._elsewhere.setdefault(operation.target, set()).add(self.test())

    def findings(self, operations: Iterable[Operation]) -> Iterator[tuple[Operation, Finding]]:
        """What is to be said about these operations."""
        for operation in operations:
            said = list(self._said(operation))
            if said:
                yield operation, Finding("call", "; ".join(said), is_remark=True)
            alone = self._alone.pop(last_name(operation), {})
            if alone:
                listed = ", ".join(f"{place} ({what})" for place, what in list(alone.items())[:_MOST])
                more = f" and {len(alone) - _MOST} more" if len(alone) > _MOST else ""
                text = f"{_calls(len(alone))} of this name left alone, since nothing says that it is meant"
                advice = f'if it is, write method = "{last_name(operation)}"'
                yield operation, Finding("method", f"{text}: {listed}{more}; {advice}", is_remark=True)

    def _said(self, operation: Operation) -> Iterator[str]:
        """What stood for an operation, and what nobody can place."""
        stood = self._standing.get(operation.target, {})
        if stood and not operation.target.startswith(ANY):
            yield "in its place stands " + ", ".join(
                f"{what} in {_tests(len(tests))}" for what, tests in stood.items()
            )
        elsewhere = self._elsewhere.get(operation.target)
        if elsewhere:
            which = _tests(len(elsewhere))
            yield f"handed on in several places and called in a thread in {which}: such calls are not mutated"


def last_name(operation: Operation) -> str:
    """What a call of an operation ends with."""
    return operation.qualname.rpartition(".")[2]


def is_mock(mock: Any, value: Any) -> bool:
    """Whether a value is a mock, whatever it says that it is."""
    return issubclass(type(value), mock.NonCallableMock)


def _shown(found: Any, receiver: Any) -> str:
    mock = sys.modules.get("unittest.mock")
    if mock is not None and (is_mock(mock, found) or is_mock(mock, receiver)):
        return "a mock"
    if receiver is NOTHING or isinstance(receiver, ModuleType):
        return str(getattr(type(found), "__name__", ""))
    return class_name(receiver if isinstance(receiver, type) else type(receiver))


def _tests(count: int) -> str:
    return "1 test" if count == 1 else f"{count} tests"


def _calls(count: int) -> str:
    return "1 call" if count == 1 else f"{count} calls"
