"""Handlers around all that a vocabulary names, of whatever kind."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from importlib import import_module

from mutabot.model import Operation

from .target import Handler, Targets, Tell

#: the kind of a target that says nothing else
_DEFAULT = "callables"


class Interception:
    """The targets of one process, by their kinds.

    Args:
        tell: told about a target that turns out wrong when it is found.
    """

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self._kinds: dict[str, Targets] = {}

    def of(self, kind: str | None = None) -> Targets:
        """All targets of a kind; by default Python callables."""
        name = kind or _DEFAULT
        if name not in self._kinds:
            self._kinds[name] = import_module(f"{__package__}.{name}").KIND(self._tell)
        return self._kinds[name]

    def wrap(
        self, operation: Operation, handler: Handler, overrides: Callable[[type], Handler] | None = None
    ) -> None:
        """Let a handler stand around an operation; see ``Targets.wrap``."""
        self.of(operation.kind).wrap(operation.target, handler, overrides)

    @property
    def kinds(self) -> Iterable[Targets]:
        """All kinds that are in use."""
        return self._kinds.values()

    @property
    def found(self) -> frozenset[str]:
        """The targets that this process has."""
        return frozenset(name for targets in self._kinds.values() for name in targets.here())

    def found_elsewhere(self, names: Iterable[str]) -> None:
        """A process below the tests has these targets: nobody needs to seek them here."""
        for targets in self._kinds.values():
            targets.found_elsewhere(names)

    def look_again(self) -> None:
        """A test begins: find what was made since the last one."""
        for targets in self._kinds.values():
            targets.look_again()

    def remove(self) -> None:
        """Take all handlers away."""
        for targets in self._kinds.values():
            targets.remove()
