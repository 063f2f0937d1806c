"""weak-grip: a gripper is weak."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.operators._evidence import PARAMETERS
from mutabot.operators.operator import Example, Subject

from ._override import Override

_F = Quantity("newtons", Path("newtons"), Kind.FORCE, unit="N", range=(20.0, 235.0))
_SET = Operation("robot:Gripper.set_force", (_F,))
_MOTIONS = frozenset({Kind.TRANSLATION, Kind.ROTATION})


class WeakGrip(Override):
    """Leaves a gripper 30 % of its force."""

    name = "weak-grip"
    summary = "A gripper has 30 % of the force that it is told to have, or the least of its range."
    rank = 352
    stands_for = f"A wrong parameter: {PARAMETERS}."
    where = "written quantities of kind force, in calls that command no motion"
    variants = ("x0.3",)
    kinds = frozenset({Kind.FORCE})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_SET, quantity=_F, variant="x0.3"), {"newtons": 160}, performed=({"newtons": 48},)),
        Example(
            Subject(_SET, quantity=_F, variant="x0.3"),
            {"newtons": 40},
            performed=({"newtons": 20},),
            note="the least of its range",
        ),
        Example(Subject(_SET, quantity=_F, variant="x0.3"), {"newtons": 20}, away="it is the least already"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        is_motion = any(one.kind in _MOTIONS or one.is_whole for one in whole.written)
        return super().fits(quantity, whole) and not is_motion
