"""silent-limit: a command is limited, and nobody says so."""

from __future__ import annotations

from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import PARAMETERS
from mutabot.operators.catalogue._shape import ValueFault, like, middle_of, within
from mutabot.operators.operator import Example, Subject, map_numbers
from mutabot.operators.robot._values import quantity_of

_SHARE = 0.8
_F = Quantity("newtons", Path("newtons"), Kind.FORCE, unit="N", range=(0.0, 100.0))
_SET = Operation("robot:Gripper.set_force", (_F,))


class SilentLimit(ValueFault):
    """Limits a commanded number to the middle of its range."""

    name = "silent-limit"
    summary = "A commanded value is limited to the middle 80 % of its range, without notice."
    rank = 355
    stands_for = f"A wrong parameter: {PARAMETERS}."
    where = "written numbers with a range or clip"
    of_read = False
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_SET, quantity=_F), {"newtons": 100}, performed=({"newtons": 90},)),
        Example(Subject(_SET, quantity=_F), {"newtons": 50}, away="it is within"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        limits = quantity.range or quantity.clip
        is_number = quantity.is_measured or quantity.kind in (Kind.OPENING, Kind.OUTPUT)
        return is_number and limits is not None and quantity.values is None and not quantity.is_whole

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        limits = middle_of(quantity_of(subject), _SHARE)
        return map_numbers(value, lambda number: like(number, within(number, limits)))
