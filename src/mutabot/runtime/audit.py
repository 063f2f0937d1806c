"""Listen to audit events: one hook hands each event to those that asked for it.

Python calls every hook at every event, and ``sys._getframe`` is one, which notes in the program text ask for
at each call. A hook cannot be taken back.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from typing import Any

#: told an event's name and its arguments
Hear = Callable[[str, tuple[Any, ...]], None]
#: lists: a listener may add another one, which hears the same event
_listeners: dict[str, list[Hear]] = {}
#: from the frame of a listener to that of what caused the event
FRAMES = 2


def listen(events: Iterable[str], hear: Hear) -> None:
    """Let ``hear`` have these events from now on."""
    if not _listeners:
        sys.addaudithook(_hear)
    for event in events:
        _listeners.setdefault(event, []).append(hear)


def _hear(event: str, arguments: tuple[Any, ...]) -> None:
    for hear in _listeners.get(event, ()):
        hear(event, arguments)
