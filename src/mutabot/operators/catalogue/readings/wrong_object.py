"""wrong-object: a reading is that of another object or channel."""

from __future__ import annotations

from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import SENSORS
from mutabot.operators.catalogue._shape import Away, ValueFault
from mutabot.operators.operator import Example, Subject
from mutabot.operators.robot._values import quantity_of

_WHICH = Quantity("which", Path("which"), Kind.OUTPUT, values=("nut", "bolt", "washer"))
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "m")
_FIND = Operation("camera:distance_of", (_WHICH,), (_GAP,), command=False)


class WrongObject(ValueFault):
    """Asks for the next of the objects that can be asked for."""

    name = "wrong-object"
    summary = "A reading is that of another object, camera or channel than the one that is asked for."
    rank = 346
    stands_for = f"A sensor that drops out or is misread: {SENSORS}."
    where = "outputs with values that say what a call reads: written beside a result"
    of_read = False
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_FIND, quantity=_WHICH),
            {"which": "washer"},
            replied={"result": 0.3},
            performed=({"which": "nut"},),
        ),
        Example(
            Subject(_FIND, quantity=_WHICH), {"which": "screw"}, away="it is none of those that are known"
        ),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return bool(whole.read) and quantity.kind is Kind.OUTPUT and len(quantity.values or ()) > 1

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        values = quantity_of(subject).values or ()
        if value not in values:
            raise Away("it is none of those that are known")
        return values[(values.index(value) + 1) % len(values)]
