"""force-override: a force is half as big, or twice as big."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.operators._evidence import PARAMETERS
from mutabot.operators.operator import Example, Subject

from ._override import Override

_F = Quantity("force", Path("force"), Kind.FORCE, unit="N")
_PRESS = Operation("robot:Arm.press", (_F,))


class ForceOverride(Override):
    """Halves or doubles a force or torque."""

    name = "force-override"
    summary = "A force or torque is 50 % or 200 % of what is commanded, within its range."
    rank = 351
    stands_for = f"A wrong parameter: {PARAMETERS}."
    where = "written quantities of kind force or torque"
    kinds = frozenset({Kind.FORCE, Kind.TORQUE})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_PRESS, quantity=_F, variant="x0.5"), {"force": 40.0}, performed=({"force": 20.0},)),
        Example(Subject(_PRESS, quantity=_F, variant="x2"), {"force": 40.0}, performed=({"force": 80.0},)),
        Example(Subject(_PRESS, quantity=_F, variant="x2"), {"force": 0.0}, away="twice nothing is nothing"),
    )
