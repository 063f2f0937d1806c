"""early: a wait is shorter."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.units import Dimension
from mutabot.operators._evidence import TIMING
from mutabot.operators.graded._ladders import Ladder, ladder_in
from mutabot.operators.graded._shape import GradedOperator, Passed
from mutabot.operators.operator import Example, Subject

_WAIT = Quantity("seconds", Path("seconds"), Kind.DURATION, unit="s", range=(0.0, 3600.0))
_PAUSE = Operation("cell:Cell.wait", (_WAIT,))


class Early(GradedOperator):
    """Ends a wait before its time."""

    name = "early"
    summary = "A wait is so much shorter, so that what comes next comes too early."
    where = "waits: arguments of kind `duration`"
    stands_for = f"A wait that was measured on a faster machine: {TIMING}."
    rank = 270
    directions = ("-",)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_PAUSE, None, _WAIT, "-200ms", 200.0, "ms", "-"),
            {"seconds": 0.8},
            performed=({"seconds": 0.6},),
            note="the gripper is given less time to close",
        ),
        Example(
            Subject(_PAUSE, None, _WAIT, "-1000ms", 1000.0, "ms", "-"),
            {"seconds": 0.8},
            away="no wait is shorter than nothing",
        ),
    )

    def ladder(self, quantity: Quantity, *, written: bool) -> Ladder | None:
        return ladder_in(quantity, Dimension.TIME) if written and quantity.kind is Kind.DURATION else None

    def number(self, size: float, value: float, passed: Passed) -> float:
        after = value + size
        return after if after >= -1e-9 else value
