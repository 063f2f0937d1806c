"""The program's time, as mutants ask for it: what time it is, and letting some of it pass."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from mutabot.inside.limits import Meter
from mutabot.inside.readings.instances import Instances
from mutabot.inside.targets.names import resolve
from mutabot.model import Vocabulary
from mutabot.model.values.units import convert


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

    @property
    def can_wait(self) -> bool:
        """Whether something lets time pass."""
        return self.vocabulary.wait is not None

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
            objects = self.instances.of(wait.owner)
            if not objects:
                raise LookupError(f"the program has no object of {wait.owner}, which lets its time pass")
            found = getattr(objects[-1], name)
        waited = found(convert(seconds, "s", wait.unit))
        if inspect.isawaitable(waited):
            await waited
