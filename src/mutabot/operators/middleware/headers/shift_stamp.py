"""shift-stamp: a message says that it is older or newer than it is."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import HEAR_STAMP, HEARD_STAMP, SEND_STAMP, STAMP
from mutabot.operators.middleware._values import Away, ValueOperator, quantity_of
from mutabot.operators.operator import Example, Subject

#: seconds: more than programs that check the age of a message put up with. Less than 2 s is no difference
#: between two numbers of seconds since 1970, as values are compared
_SHIFTS = {"-5": -5.0, "5": 5.0}


class ShiftStamp(ValueOperator):
    """Moves the stamp of a message."""

    name = "shift-stamp"
    summary = "The header's stamp lies 5 s in the past or in the future."
    rank = 220
    variants = tuple(_SHIFTS)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(SEND_STAMP, quantity=STAMP, variant="-5"),
            {"header.stamp": 20.0},
            performed=({"header.stamp": 15.0},),
        ),
        Example(
            Subject(HEAR_STAMP, quantity=HEARD_STAMP, variant="5"),
            replied={"header.stamp": 20.0},
            performed=({},),
            received={"header.stamp": 25.0},
        ),
        Example(
            Subject(SEND_STAMP, quantity=STAMP, variant="5"), {"header.stamp": 0.0}, away="the stamp is empty"
        ),
        Example(
            Subject(SEND_STAMP, quantity=STAMP, variant="-5"),
            {"header.stamp": 2.0},
            away="no stamp is before zero",
        ),
    )

    def fits(self, quantity: Quantity) -> bool:
        return quantity.kind is Kind.STAMP

    def change(self, subject: Subject, value: Value) -> Value:
        if not value:
            raise Away("the stamp is empty")
        shifted = value + _SHIFTS[subject.variant]
        if shifted < 0:
            raise Away("no stamp is before zero")
        return shifted

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        shift = _SHIFTS[subject.variant]
        when = "past" if shift < 0 else "future"
        return f"{quantity_of(subject).name} lies {abs(shift):g} s in the {when}"
