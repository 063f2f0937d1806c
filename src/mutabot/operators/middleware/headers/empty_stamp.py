"""empty-stamp: a message does not say when it was."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import HEAR_STAMP, HEARD_STAMP, SEND_STAMP, STAMP
from mutabot.operators.middleware._values import Away, ValueOperator, quantity_of
from mutabot.operators.operator import Example, Subject


class EmptyStamp(ValueOperator):
    """Puts zero in the place of the stamp."""

    name = "empty-stamp"
    summary = "The header has no stamp: it says zero, as if nobody had filled it in."
    rank = 230
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(SEND_STAMP, quantity=STAMP), {"header.stamp": 20.0}, performed=({"header.stamp": 0.0},)
        ),
        Example(
            Subject(HEAR_STAMP, quantity=HEARD_STAMP),
            replied={"header.stamp": 20.0},
            performed=({},),
            received={"header.stamp": 0.0},
        ),
        Example(
            Subject(SEND_STAMP, quantity=STAMP), {"header.stamp": 0.0}, away="the stamp is empty already"
        ),
    )

    def fits(self, quantity: Quantity) -> bool:
        return quantity.kind is Kind.STAMP

    def change(self, subject: Subject, value: Value) -> Value:
        if not value:
            raise Away("the stamp is empty already")
        return 0.0

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return f"{quantity_of(subject).name} is empty"
