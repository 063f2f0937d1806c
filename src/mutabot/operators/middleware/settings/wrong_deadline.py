"""wrong-deadline: messages are promised, or asked for, at another pace."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import ADVERTISE, SUBSCRIBE, setting_of
from mutabot.operators.middleware._values import Away, SettingOperator
from mutabot.operators.operator import Example, Subject

_TIGHT = "tight"
_NONE = "none"
#: seconds: more often than any of the programs this is for publishes
_SHORT = 0.001
_OFFERED = setting_of(ADVERTISE, "deadline")
_ASKED = setting_of(SUBSCRIBE, "deadline")


class WrongDeadline(SettingOperator):
    """Sets a deadline that nobody keeps, or takes one away; 0 is none."""

    name = "wrong-deadline"
    summary = (
        "A publisher or subscription has a deadline of 1 ms, or none where it had one. A subscription that"
        " asks for more than is offered hears nothing."
    )
    rank = 360
    setting = "deadline"
    variants = (_TIGHT, _NONE)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(SUBSCRIBE, quantity=_ASKED, variant=_TIGHT),
            {"deadline": 0.0},
            performed=({"deadline": 0.001},),
        ),
        Example(
            Subject(ADVERTISE, quantity=_OFFERED, variant=_NONE),
            {"deadline": 0.1},
            performed=({"deadline": 0.0},),
        ),
        Example(Subject(ADVERTISE, quantity=_OFFERED, variant=_NONE), {"deadline": 0.0}, away="it has none"),
    )

    def change(self, subject: Subject, value: Value) -> Value:
        if subject.variant == _TIGHT:
            return _SHORT
        if not value:
            raise Away("it has none")
        return 0.0
