"""deadband: small changes go unheard."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators._evidence import SENSORS
from mutabot.operators.graded._ladders import Ladder, own_ladder
from mutabot.operators.graded._shape import GradedOperator, Passed
from mutabot.operators.operator import Example, Subject

_X = Quantity("x", Path("x"), Kind.TRANSLATION, "x", "m", "base", Mode.TO)
_GAP = Quantity("result", Path(), Kind.DISTANCE, unit="m")
_GO = Operation("robot:Arm.move_to", (_X,))
_FEEL = Operation("sensor:gap", result=(_GAP,), command=False)


class Deadband(GradedOperator):
    """Keeps to the last value until a new one is further off than the band."""

    name = "deadband"
    summary = (
        "A target or reading that differs from the last one by less than δ is taken for that one; a relative "
        "move shorter than δ is none. As by a worn gear, or a filter against chatter."
    )
    where = "every number that is commanded or read, bar waits and orientations as a whole"
    stands_for = f"Backlash of a worn gear, or a filter against chatter: {SENSORS}."
    rank = 250
    directions = ("",)
    remembers = True
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_GO, None, _X, "20mm", 20.0, "mm"),
            {"x": 0.41},
            earlier=({"x": 0.4},),
            performed=({"x": 0.4},),
        ),
        Example(
            Subject(_FEEL, None, _GAP, "20mm", 20.0, "mm"),
            replied={"result": 0.31},
            earlier=({"result": 0.3},),
            performed=({},),
            received={"result": 0.3},
        ),
        Example(
            Subject(_GO, None, _X, "20mm", 20.0, "mm"),
            {"x": 0.45},
            earlier=({"x": 0.4},),
            away="it is far enough from the last target",
        ),
    )

    def ladder(self, quantity: Quantity, *, written: bool) -> Ladder | None:
        return None if quantity.is_whole or quantity.kind is Kind.DURATION else own_ladder(quantity)

    def number(self, size: float, value: float, passed: Passed) -> float:
        origin = 0.0 if passed.is_relative else passed.last
        return origin if origin is not None and abs(value - origin) < size else value

    def fault(self, subject: Subject) -> str:
        return f"with a dead band of {subject.magnitude:g}{f' {subject.unit}' if subject.unit else ''}"
