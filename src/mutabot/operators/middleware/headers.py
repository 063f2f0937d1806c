"""What the headers of messages say wrongly."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from mutabot.families import MIDDLEWARE
from mutabot.model import Kind, Quantity
from mutabot.model.operation import Form
from mutabot.model.quantity import Value, is_same
from mutabot.operators.examples import changed, unchanged
from mutabot.operators.numbers import next_of
from mutabot.operators.operator import Context, Example, Subject, Unchanged, quantity_of
from mutabot.operators.value import SAME, ValueOperator

from ._examples import FRAME, HEAR_STAMP, HEARD_FRAME, OPEN_FRAME, SEND_STAMP, operation

_EMPTY, _UNKNOWN = "empty", "unknown"
_SEND = operation(Form.PUBLISH, "/arm/target", (FRAME,))
_SEND_ANY = operation(Form.PUBLISH, "/arm/target", (OPEN_FRAME,))
_HEAR = operation(Form.RECEIVE, "/scan", result=(HEARD_FRAME,))


class FreeValueOperator(ValueOperator):
    """Changes a value that a middleware takes whatever it is."""

    family = MIDDLEWARE

    def why_unchanged(self, quantity: Quantity, before: Value, after: Value | None) -> str:
        return SAME if is_same(quantity, after, before) else ""

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        one, other = quantity.texts(before, after)
        return f"{quantity.name} {one or '“”'} → {other or '“”'}"


class WrongFrame(FreeValueOperator):
    """The header names another frame: the next of those that the vocabulary gives, one that nobody knows if
    it gives none, or none at all.
    """

    name = "wrong-frame"
    rank = 210
    kinds = frozenset({Kind.FRAME_ID})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_SEND, "base", "tool"),
        changed(_SEND_ANY, "base", "base_unknown", _UNKNOWN),
        changed(_HEAR, "base", "", _EMPTY),
        unchanged(_SEND, "", "the value would stay the same", _EMPTY),
    )

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        return ("" if quantity.values else _UNKNOWN, _EMPTY)

    def change(self, value: Value, context: Context) -> Value | None:
        if context.subject.variant == _EMPTY:
            return ""
        if context.subject.variant == _UNKNOWN:
            return f"{value}_unknown"
        if value not in (context.quantity.values or ()):
            raise Unchanged(f"{value!r} is none of the frames that the vocabulary gives")
        return next_of(value, context.quantity)


class ShiftStamp(FreeValueOperator):
    """The header's stamp lies 5 s in the past or in the future."""

    name = "shift-stamp"
    rank = 220
    kinds = frozenset({Kind.STAMP})
    #: seconds: more than programs that check the age of a message put up with. Less than 2 s is no difference
    #: between two numbers of seconds since 1970, as values are compared
    variants: ClassVar[Mapping[str, float]] = {"-5": -5.0, "5": 5.0}
    examples: ClassVar[tuple[Example, ...]] = (
        changed(SEND_STAMP, 20.0, 15.0, "-5"),
        changed(HEAR_STAMP, 20.0, 25.0, "5"),
        unchanged(SEND_STAMP, 0.0, "the stamp is empty", "5"),
        unchanged(SEND_STAMP, 2.0, "no stamp is before zero", "-5"),
    )

    def change(self, value: Value, context: Context) -> Value | None:
        if not value:
            raise Unchanged("the stamp is empty")
        shifted = value + context.option
        if shifted < 0:
            raise Unchanged("no stamp is before zero")
        return shifted

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        when = "past" if subject.variant.startswith("-") else "future"
        return f"{quantity_of(subject).name} lies 5 s in the {when}"


class EmptyStamp(FreeValueOperator):
    """The header has no stamp: it says zero, as if nobody had filled it in."""

    name = "empty-stamp"
    rank = 230
    kinds = frozenset({Kind.STAMP})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(SEND_STAMP, 20.0, 0.0),
        changed(HEAR_STAMP, 20.0, 0.0),
        unchanged(SEND_STAMP, 0.0, "the stamp is empty already"),
    )

    def change(self, value: Value, context: Context) -> Value | None:
        if not value:
            raise Unchanged("the stamp is empty already")
        return 0.0

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return f"{quantity_of(subject).name} is empty"
