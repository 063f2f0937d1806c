"""negate: a reading has the wrong sign."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import PLAIN, Value
from mutabot.operators.operator import Example, Subject, map_numbers
from mutabot.operators.rule import Published

from ._orientation import the_other_way
from ._values import ReadValueOperator, quantity_of

_X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m", "world")
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "mm")
_TURNED = Quantity("result", Path(), Kind.QUATERNION, order="wxyz")
_LOOK = Operation("camera:orientation", result=(_TURNED,), command=False)
_LOCATE = Operation("camera:locate", result=(_X,), command=False)
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)


class Negate(ReadValueOperator):
    """Negates one component of a reading."""

    name = "negate"
    summary = "A position, distance or angle is read with the wrong sign."
    rank = 60
    where = "read positions, distances, angles and orientations"
    published = (Published(9, "distance value is x", "distance value is −x"),)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_LOCATE, quantity=_X),
            replied={".x": 0.55},
            performed=({},),
            received={".x": -0.55},
            note="distance value is x: distance value is −x",
        ),
        Example(
            Subject(_MEASURE, quantity=_GAP),
            replied={"result": 12},
            performed=({},),
            received={"result": -12},
        ),
        Example(
            Subject(_LOOK, quantity=_TURNED),
            replied={"result": [0.8, 0.6, 0.0, 0.0]},
            performed=({},),
            received={"result": [0.8, -0.6, 0.0, 0.0]},
            note="an orientation as a whole: the inverse rotation",
        ),
        Example(Subject(_LOCATE, quantity=_X), replied={".x": 0.0}, away="a zero has no sign"),
        Example(Subject(_LOCATE, quantity=_X), replied={}, away="the reading has no such part this time"),
    )

    def fits(self, quantity: Quantity) -> bool:
        return quantity.is_measured and quantity.kind not in PLAIN

    def change(self, subject: Subject, value: Value, random: Random) -> Value | None:
        quantity = quantity_of(subject)
        if quantity.is_whole:
            return the_other_way(quantity, value)
        return map_numbers(value, lambda number: -number)
