"""confused-label: a label is read as another one now and then."""

from __future__ import annotations

from random import Random
from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._draws import Draws
from mutabot.operators._evidence import SENSORS
from mutabot.operators.catalogue._shape import Away, ValueFault
from mutabot.operators.operator import Example, Subject
from mutabot.operators.robot._values import label, quantity_of

_SHARES = {"30%": 0.3}
_COLOUR = Quantity("result", Path(), Kind.LABEL, values=("red", "blue"))
_SEE = Operation("camera:colour", result=(_COLOUR,), command=False)


class ConfusedLabel(ValueFault):
    """Gives the next of a label's values, by chance."""

    name = "confused-label"
    summary = "A label or flag is read as the next of its values, with a probability of 30 %."
    rank = 347
    remembers = True
    copies = False
    stands_for = f"A sensor that drops out or is misread: {SENSORS}."
    where = "read quantities of kind label or flag with two values or more"
    of_written = False
    variants = tuple(_SHARES)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_SEE, quantity=_COLOUR, variant="30%"),
            replied={"result": "red"},
            performed=({},),
            received={"result": "blue"},
        ),
        Example(
            Subject(_SEE, quantity=_COLOUR, variant="30%"),
            replied={"result": "red"},
            earlier=({"result": "red"},) * 3,
            away="most are read rightly",
        ),
    )

    def is_chance(self, subject: Subject) -> bool:
        return True

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind in (Kind.LABEL, Kind.FLAG) and len(quantity.values or ()) > 1

    def memory(self, random: Random) -> Draws:
        return Draws(random)

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        if memory.next().random() >= _SHARES[subject.variant]:
            raise Away("chance spares it")
        values = quantity_of(subject).values or ()
        if value not in values:
            raise Away("it is none of those that are known")
        return values[(values.index(value) + 1) % len(values)]

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return f"reads another {label(quantity_of(subject))}, with a probability of {subject.variant}"
