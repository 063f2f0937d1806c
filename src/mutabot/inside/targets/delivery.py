"""Giving the program what comes by itself, as a mutant would have it: late, several times, or not at all.

Around what comes by itself (``model.named.COMING``) a handler may return a ``Delivery`` in the place of the
message. The hooks of all middlewares leave it to the two functions here: ``deliver`` where a callback of the
program's is called, ``wait_for`` where the program waits.
"""

from __future__ import annotations

import inspect
import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from mutabot.frozen import frozen

from .target import Handler, Means, Where

#: seconds of wall clock: a topic that keeps its last message gives it at once to who asks again and again
_PAUSE = 0.01


@frozen
class Delivery:
    """What the program is to receive in the place of one message.

    Attributes:
        parts: seconds by which each comes later, and the message; none if it is lost.
    """

    parts: tuple[tuple[float, Any], ...] = ()


def deliver(handler: Handler, message: Any, callback: Callable[[Any], Any], where: Where) -> Any:
    """Call the program's callback with a message, or with whatever the handler makes of it.

    Returns what the callback returns: a coroutine if it is a coroutine function. A message that is lost calls
    nothing and returns None; one that is late calls it from ``where.means.later``.
    """
    received = handler(lambda: message, None, (), {}, where)
    if not isinstance(received, Delivery):
        return callback(received)
    returned = []
    for late, part in received.parts:
        if late:
            _means(where).later(late, partial(callback, part))
        else:
            returned.append(callback(part))
    if any(inspect.isawaitable(one) for one in returned):
        return _in_turn(returned)
    return returned[-1] if returned else None


def wait_for(handler: Handler, wait: Callable[[], Any], where: Where) -> Any:
    """What a program receives that waits for one message; ``wait`` waits for the next and returns it.

    A message that is lost is waited past, so ``wait`` may be called again: it keeps the time-out of the
    whole, and raises what the program is to see when that is over. Who has a message waits no more, and the
    next wait subscribes anew: a mutant can let nothing come after it (``Means.once``).
    """
    where = replace(where, means=replace(_means(where), once=True))
    while True:
        received = handler(wait, None, (), {}, where)
        if not isinstance(received, Delivery):
            return received
        for late, part in received.parts:
            if late:
                _done(_means(where).sleep(late))
            return part
        where = replace(where, is_again=True)
        time.sleep(_PAUSE)


def anew(wait: Callable[[], Any], is_kept: Callable[[Any], bool]) -> Callable[[], Any]:
    """Wait for a message that no wait before has brought.

    Each wait subscribes anew, and so gets once more what is kept for late subscribers: a node that had lost
    it would not. ``is_kept`` says whether a message is of that kind.
    """
    last: list[Any] = []

    def wait_for_another() -> Any:
        while True:
            message = wait()
            if not last or not is_kept(message) or message != last[0]:
                last[:] = [message]
                return message
            time.sleep(_PAUSE)

    return wait_for_another


def _means(where: Where) -> Means:
    return where.means if where.means is not None else Means()


def _done(awaitable: Awaitable[None]) -> None:
    """Await what does not suspend."""
    for _ in awaitable.__await__():
        raise RuntimeError("the sleep of a plain call suspends; it must block")


async def _in_turn(returned: Sequence[Any]) -> Any:
    last = None
    for one in returned:
        last = await one if inspect.isawaitable(one) else one
    return last
