"""What a middleware can let happen to a call, beside other values: it comes late, its answer never does."""

from __future__ import annotations

import threading
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any


async def _sleep(seconds: float) -> None:
    time.sleep(seconds)


def _later(seconds: float, action: Callable[[], object]) -> None:
    timer = threading.Timer(seconds, action)
    timer.daemon = True
    timer.start()


@dataclass(frozen=True, slots=True)
class Means:
    """How a call of a middleware is made late, lost and so on; the hook that has the call knows.

    Seconds are those of the node's own clock, so that simulated time counts.

    Attributes:
        sleep: waits for so many seconds. Around a plain call it must not suspend: it blocks. Around a
            coroutine function it may await whatever that may await.
        later: has a callback called after so many seconds, as the node calls others, and returns at once.
        goes_out: has a message go out after so many seconds, whatever the node does meanwhile.
        lost: what the program meets when the answer it waits for never comes: raises what the middleware
            raises, or waits as long as it would; None for what has no answer.
        cancel: cancels what the call has begun, given what it returned; None for what cannot be cancelled.
        jump: lets the program's clock jump by so many seconds; None where it cannot.
        once: whether the program waits for one message: what comes after it comes to nobody.
    """

    sleep: Callable[[float], Awaitable[None]] = _sleep
    later: Callable[[float, Callable[[], object]], None] = _later
    lost: Callable[[], Awaitable[Any]] | None = None
    cancel: Callable[[Any], Awaitable[None]] | None = None
    jump: Callable[[float], None] | None = None
    goes_out: Callable[[float, Callable[[], object]], None] = _later
    once: bool = False
