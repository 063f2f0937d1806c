"""wrong-frame: a message names another frame than the one it is given in."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from mutabot.model import Kind, Quantity
from mutabot.model.named import Form
from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import FRAME, HEARD_FRAME, OPEN_FRAME, operation
from mutabot.operators.middleware._values import Away, ValueOperator, quantity_of
from mutabot.operators.operator import Example, Subject

_EMPTY = "empty"
_UNKNOWN = "unknown"
_SEND = operation(Form.PUBLISH, "/arm/target", (FRAME,))
_SEND_ANY = operation(Form.PUBLISH, "/arm/target", (OPEN_FRAME,))
_HEAR = operation(Form.RECEIVE, "/scan", result=(HEARD_FRAME,))


class WrongFrame(ValueOperator):
    """Puts another name in the place of the frame."""

    name = "wrong-frame"
    summary = (
        "The header names another frame: the next of those that the vocabulary gives, one that nobody "
        "knows if it gives none, or none at all."
    )
    rank = 210
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_SEND, quantity=FRAME),
            {"header.frame_id": "base"},
            performed=({"header.frame_id": "tool"},),
        ),
        Example(
            Subject(_SEND_ANY, quantity=OPEN_FRAME, variant=_UNKNOWN),
            {"header.frame_id": "base"},
            performed=({"header.frame_id": "base_unknown"},),
        ),
        Example(
            Subject(_HEAR, quantity=HEARD_FRAME, variant=_EMPTY),
            replied={"header.frame_id": "base"},
            performed=({},),
            received={"header.frame_id": ""},
        ),
        Example(
            Subject(_SEND, quantity=FRAME, variant=_EMPTY),
            {"header.frame_id": ""},
            away="the value would stay the same",
        ),
    )

    def fits(self, quantity: Quantity) -> bool:
        return quantity.kind is Kind.FRAME_ID

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        return ("" if quantity.values else _UNKNOWN, _EMPTY)

    def change(self, subject: Subject, value: Value) -> Value:
        if subject.variant == _EMPTY:
            return ""
        if subject.variant == _UNKNOWN:
            return f"{value}_unknown"
        values = quantity_of(subject).values or ()
        if value not in values:
            raise Away(f"{value!r} is none of the frames that the vocabulary gives")
        return values[(values.index(value) + 1) % len(values)]
