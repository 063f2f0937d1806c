"""The program's time: read at every call that advances the simulation, or counted in fixed steps."""

from __future__ import annotations

import inspect
import reprlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from types import CoroutineType
from typing import Any

from mutabot.errors import PathError
from mutabot.model import Clock, Vocabulary
from mutabot.model.path import Path
from mutabot.model.signature import ANYTHING, signature_of
from mutabot.model.units import convert
from mutabot.runtime.evidence import Meter
from mutabot.runtime.interception.adapter import Invocation
from mutabot.runtime.observation.instances import Instances
from mutabot.runtime.targets.target import resolve


class ClockReader:
    """Tells a meter about the calls of the clock's tick.

    Args:
        clock: what the vocabulary says.
        meter: the meter of the running test; None between tests.
        on_problem: told why a call gives no time: (key, text).
    """

    def __init__(
        self, clock: Clock, meter: Callable[[], Meter | None], on_problem: Callable[[str, str], None]
    ) -> None:
        self._clock, self._meter, self._on_problem = clock, meter, on_problem
        self._path = Path.parse(clock.time, rooted=clock.rooted)
        self._step = None if clock.step is None else convert(clock.step, clock.unit, "s")
        self._is_direct = not clock.time and self._step is None and clock.unit == "s"

    def handle(self, wrapped: Callable[..., Any], instance: Any, args: Any, kwargs: Any) -> Any:
        """Stand around the tick."""
        __tracebackhide__ = True
        result = wrapped(*args, **kwargs)
        if self._is_direct and type(result) is float and isfinite(result):  # the way of most simulators
            meter = self._meter()
            if meter is not None:
                meter.tick(result)
        elif isinstance(result, CoroutineType):  # nothing has happened yet
            return self._awaited(result, wrapped, instance, args, kwargs)
        else:
            self._told(result, wrapped, instance, args, kwargs)
        return result

    async def _awaited(self, result: Any, *call: Any) -> Any:
        __tracebackhide__ = True
        result = await result
        self._told(result, *call)
        return result

    def _told(self, result: Any, *call: Any) -> None:
        __tracebackhide__ = True
        meter = self._meter()
        if meter is None:
            return
        if self._step is not None:
            meter.advance(self._step)
        elif (time := self._time(result, *call)) is not None:
            meter.tick(time)

    def _time(self, result: Any, *call: Any) -> float | None:
        """Simulated time in s after the call; None, and a problem, if there is none."""
        try:
            value = self._path.get(self._start(*call) if self._path.root is not None else result)
        except PathError as error:
            self._wrong(str(error))
            return None
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = float("nan")
        if not isfinite(number):
            where = (
                f"the path {self._clock.time!r}" if self._clock.time else f"what {self._clock.tick} returns"
            )
            self._wrong(f"{where} gives {reprlib.repr(value)}, which is no number")
            return None
        return convert(number, self._clock.unit, "s")

    def _start(self, *call: Any) -> Any:
        """The object or argument at which the path begins. Raises PathError if the call has none."""
        invocation = Invocation(*call)
        invocation.bind(signature_of(invocation.wrapped) or ANYTHING)
        start, known = invocation.start_of(self._path), tuple(invocation.values or ())
        root = self._path.root or ""
        if start is None and root not in known:
            of_call = f"has no argument {root!r}; it has {', '.join(known)}"
            why = "is no method, so it has no self" if root == "self" else of_call
            raise PathError(f"{self._clock.tick} {why}", step=root, known=known)
        return start

    def _wrong(self, text: str) -> None:
        self._on_problem(
            "time", f"{text}; name a path that gives the time as a number, or write step = … instead"
        )


@dataclass(slots=True)
class ProgramTime:
    """The time of the running test.

    Attributes:
        vocabulary: names the clock, and what lets time pass.
        meter: the meter of the running test; None between tests.
        instances: the objects that the program uses.
    """

    vocabulary: Vocabulary
    meter: Callable[[], Meter | None]
    instances: Instances

    def now(self) -> float:
        """Simulated seconds since the test's first tick, 0 before. Raises LookupError without a clock."""
        meter = self.meter()
        if self.vocabulary.clock is None or meter is None:
            raise LookupError("the vocabulary names no clock")
        return meter.simulated or 0.0

    def now_if_known(self) -> float | None:
        """The same; None without a clock."""
        return self.now() if self.vocabulary.clock is not None and self.meter() is not None else None

    async def wait(self, seconds: float) -> None:
        """Let so much time pass. Raises LookupError where the vocabulary does not say how."""
        wait = self.vocabulary.wait
        if wait is None:
            raise LookupError("the vocabulary does not say what lets the program's time pass (wait = …)")
        module, _, qualname = wait.target.partition(":")
        found: Any
        if module not in sys.modules:
            raise LookupError(f"{module}, which lets the program's time pass, is not imported")
        owner, name, found = resolve(sys.modules[module], qualname)
        if isinstance(owner, type):
            objects = self.instances.of(of := wait.target.rpartition(".")[0])
            if not objects:
                raise LookupError(f"the program has no object of {of}, which lets its time pass")
            found = getattr(objects[-1], name)
        waited = found(convert(seconds, "s", wait.unit))
        if inspect.isawaitable(waited):
            await waited
