"""misread: a label or flag is read as another one."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Pattern, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators.operator import Example, Subject
from mutabot.operators.rule import Published

from ._values import ReadValueOperator, quantity_of

#: up to this many labels, each other label is a mutant of its own; with more, only the next one is
ALL_UP_TO = 4

_COLOUR = Quantity("result", Path(), Kind.LABEL, values=("red", "blue"))
_PART = Quantity("result", Path(), Kind.LABEL, values=("nut", "bolt", "washer"))
_HELD = Quantity("result", Path(), Kind.FLAG, values=(False, True))
_SEE = Operation("camera:colour", result=(_COLOUR,), command=False)
_SORT = Operation("camera:part", result=(_PART,), command=False)
_FEEL = Operation("gripper:holding", result=(_HELD,), command=False)


class Misread(ReadValueOperator):
    """Returns another label of the quantity's values."""

    name = "misread"
    summary = "A label, such as a colour, or a flag is read as another one."
    rank = 80
    where = "read labels and flags"
    published = (Published(12, "a colour is classified", "an incorrect colour is returned"),)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_SEE, quantity=_COLOUR),
            replied={"result": "red"},
            performed=({},),
            received={"result": "blue"},
            note="an incorrect colour classification",
        ),
        Example(
            Subject(_SORT, quantity=_PART, variant="+2"),
            replied={"result": "bolt"},
            performed=({},),
            received={"result": "nut"},
        ),
        Example(
            Subject(_FEEL, quantity=_HELD),
            replied={"result": True},
            performed=({},),
            received={"result": False},
        ),
        Example(Subject(_SEE, quantity=_COLOUR), replied={"result": "grey"}, away="not one of the labels"),
    )

    def fits(self, quantity: Quantity) -> bool:
        return quantity.kind in (Kind.LABEL, Kind.FLAG) and len(quantity.values or ()) > 1

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        for subject in super().subjects(operation, pattern):
            labels = len(quantity_of(subject).values or ())
            shifts = range(1, labels) if 2 < labels <= ALL_UP_TO else range(1, 2)
            for shift in shifts:
                variant = f"+{shift}" if len(shifts) > 1 else ""
                yield Subject(operation, pattern, subject.quantity, variant)

    def change(self, subject: Subject, value: Value, random: Random) -> Value | None:
        values = quantity_of(subject).values or ()
        if value not in values:
            return None
        shift = int(subject.variant or "1")
        return values[(values.index(value) + shift) % len(values)]
