"""Interrupts: what is carried out as soon as a signal, a condition or the time says so.

They are looked at in every tick by a task of their own. While that carries one out, motions go on, and the
other tasks begin nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any

from .scope import Steps, TaskOperation
from .station import TICK, ProgramPlace

#: the name of the task
HANDLERS = "interrupts"
_NEVER = object()


@dataclass(slots=True, eq=False)
class Interrupt:
    """An interrupt.

    Attributes:
        value: looks at what it depends on.
        wanted: what that has to become; None for any change.
        handler: carries it out.
        is_single: whether it happens once.
        is_awake: whether it is heeded.
        is_pending: whether it has happened and waits for its turn.
        last: what was seen before.
    """

    value: Callable[[], Steps]
    wanted: Any
    handler: Callable[[], Steps]
    is_single: bool = False
    is_awake: bool = True
    is_pending: bool = False
    last: Any = _NEVER

    def look(self) -> Steps:
        """Look whether it happens: at a change, never at what holds from the beginning."""
        now = yield from self.value()
        is_change = self.last is not _NEVER and now != self.last
        self.last = now
        if is_change and self.is_awake and self.wanted in (None, now):
            self.is_pending = True


class Interrupts:
    """The interrupts of a run.

    Attributes:
        known: by what names them.
        are_enabled: whether any is carried out; those that happen meanwhile wait.
        is_handling: whether one is being carried out.
    """

    def __init__(self) -> None:
        self.known: dict[Hashable, Interrupt] = {}
        self.are_enabled = True
        self.is_handling = False

    def steps(self, site: ProgramPlace) -> Steps:
        """Yield the steps of the task, until there is no interrupt."""
        while self.known:
            for key, interrupt in [*self.known.items()]:
                yield from interrupt.look()
                if interrupt.is_pending and self.are_enabled and self.known.get(key) is interrupt:
                    yield from self._handle(key, interrupt)
            yield TaskOperation("wait", site, seconds=TICK)

    def _handle(self, key: Hashable, interrupt: Interrupt) -> Steps:
        interrupt.is_pending = False
        if interrupt.is_single:
            del self.known[key]
        self.is_handling = True
        try:
            yield from interrupt.handler()
        finally:
            self.is_handling = False
