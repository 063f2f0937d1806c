"""Predicts what hooks of the simulation will do, so that several control ticks can be stepped at once.

What drivers and checks compute between two ticks can take as long as the physics. In a stretch, drivers lay
down the inputs of all its ticks first, and checks look at what all its ticks were like afterwards. The first
tick at which one of them would have found something ends the stretch, so a stretch is bit by bit the same as
its ticks one by one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .geometry import Array
from .stretch import Stretch, StretchNote

Hook = Callable[[], None]


@dataclass(frozen=True, slots=True)
class InputPlan:
    """The inputs that a driver plans ahead instead of being called before each tick.

    Attributes:
        write: writes its servos' inputs, an array of the shape (ticks, physics steps in a tick, servos), and
            gives how many of the ticks these are good for. It changes nothing else.
        keep: called with the number of these ticks that have passed.
    """

    write: Callable[[Array], int]
    keep: Callable[[int], None]


@dataclass(frozen=True, slots=True)
class QuickCheck:
    """A cheap test that replaces calling a check after each tick but the last one of a stretch.

    Attributes:
        until: gives within how many ticks it must be called again, whatever happens; at least 1.
        note: called after each tick with its number in the stretch, in the order in which checks were made
            known, to remember what the stretch does not.
        quiet: given two numbers of ticks of the stretch, up to which of the ticks between them the check
            would have found nothing; in doubt too few. All before the first are known to be quiet. It is
            asked of ever later ticks, and changes nothing.
        passed: number of ticks that have passed without it.
    """

    until: Callable[[], int]
    note: StretchNote | None = None
    quiet: Callable[[Stretch, int, int], int] | None = None
    passed: Callable[[Stretch, int], None] | None = None


class Lookahead:
    """The known plans of a simulation's hooks. A hook without a plan is called at each tick.

    Attributes:
        notes: what is to be called after each tick of a stretch.
    """

    def __init__(self) -> None:
        self._plans: dict[Hook, InputPlan] = {}
        self._quick_checks: dict[Hook, QuickCheck] = {}
        self._quiet: list[Callable[[Stretch, int, int], int]] = []
        self._passed: list[Callable[[Stretch, int], None]] = []
        self.notes: list[StretchNote] = []

    def plan_inputs(self, hook: Hook, plan: InputPlan) -> None:
        """Use a plan in stretches instead of calling `hook` before each tick."""
        self._plans[hook] = plan

    def add_check(self, hook: Hook, check: QuickCheck) -> None:
        """Use a cheap test in stretches instead of calling `hook` after each tick."""
        self._quick_checks[hook] = check
        if check.note is not None:
            self.notes.append(check.note)
        if check.quiet is not None:
            self._quiet.append(check.quiet)
        if check.passed is not None:
            self._passed.append(check.passed)

    def write(self, drivers: Sequence[Hook], checks: Sequence[Hook], inputs: Array) -> int:
        """Write the inputs of as many ticks as can be stepped in one stretch; return how many these are.

        It is 1 as long as there is a hook of which nothing is known.

        Args:
            drivers, checks: the hooks before and after a tick.
            inputs: shape (ticks, physics steps in a tick, servos).
        """
        ticks = len(inputs)
        if len(drivers) != len(self._plans) or len(checks) != len(self._quick_checks):
            return 1
        for hook in checks:
            check = self._quick_checks.get(hook)
            ticks = min(ticks, check.until()) if check is not None else 1
            if ticks == 1:
                return 1
        for driver in drivers:
            plan = self._plans.get(driver)
            ticks = min(ticks, plan.write(inputs[:ticks])) if plan is not None else 1
            if ticks == 1:
                return 1
        return ticks

    def quiet(self, stretch: Stretch, known: int, ticks: int) -> int:
        """Return how many of the first ticks, in a row, no check would have objected to.

        Args:
            known: at this many at least.
        """
        for quiet in self._quiet:
            ticks = quiet(stretch, known, ticks)
        return ticks

    def keep(self, stretch: Stretch, ticks: int) -> None:
        """Record that ticks have passed; after the last of them the hooks are called."""
        for plan in self._plans.values():
            plan.keep(ticks)
        for passed in self._passed:
            passed(stretch, ticks - 1)
