"""Event loops of asyncio in a process that was forked: the descriptors by which they wait must be its own."""

from __future__ import annotations

import selectors
import sys
import weakref
from typing import Any

import wrapt

_loops: weakref.WeakSet[Any] = weakref.WeakSet()
_is_on = False


def track_event_loops() -> None:
    """Note the loops that are made from now on."""
    global _is_on  # noqa: PLW0603  # what is patched stays patched
    if _is_on:
        return
    _is_on = True
    # most processes have no loop, and need not import asyncio for it
    wrapt.register_post_import_hook(_track, "asyncio.selector_events")


def _track(selector_events: Any) -> None:
    kind = selector_events.BaseSelectorEventLoop
    make = kind._make_self_pipe

    def made(loop: Any) -> None:
        make(loop)
        _loops.add(loop)

    kind._make_self_pipe = made


def open_loops() -> list[Any]:
    """The loops that are not closed."""
    return [loop for loop in list(_loops) if not loop.is_closed()]


def descriptors_of_loops() -> set[int]:
    """The descriptors by which loops wait."""
    return {
        end.fileno()
        for loop in open_loops()
        for end in (loop._ssock, loop._csock, loop._selector)
        if end is not None
    }


def running_loop() -> Any:
    """The loop that runs in this thread, or None; to be asked before a fork."""
    events = sys.modules.get("asyncio.events")
    return events._get_running_loop() if events is not None else None


def go_on_running(loop: Any) -> None:
    """In a process that was just forked while this loop ran: it runs here, too."""
    if loop is not None:
        events: Any = sys.modules["asyncio.events"]
        events._set_running_loop(loop)
        events.set_event_loop(loop)


def own_event_loops() -> None:
    """In a process that was just forked: every loop waits by descriptors of its own."""
    for loop in open_loops():
        old, new = loop._selector, selectors.DefaultSelector()
        for key in list(old.get_map().values()):
            if key.fd != loop._ssock.fileno():
                new.register(key.fileobj, key.events, key.data)
        loop._selector = new
        old.close()
        loop._ssock.close()
        loop._csock.close()
        loop._internal_fds -= 1
        loop._make_self_pipe()
