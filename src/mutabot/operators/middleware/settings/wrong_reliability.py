"""wrong-reliability: what must arrive may be lost, or the other way round."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import ADVERTISE, SUBSCRIBE, setting_of
from mutabot.operators.middleware._values import SettingOperator, other_of
from mutabot.operators.operator import Example, Subject

_OFFERED = setting_of(ADVERTISE, "reliability")
_ASKED = setting_of(SUBSCRIBE, "reliability")


class WrongReliability(SettingOperator):
    """Swaps reliable and best effort."""

    name = "wrong-reliability"
    summary = (
        "A publisher or subscription is best effort instead of reliable, or the other way round. A "
        "subscription that asks for more than is offered hears nothing."
    )
    rank = 340
    setting = "reliability"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(ADVERTISE, quantity=_OFFERED),
            {"reliability": "reliable"},
            performed=({"reliability": "best_effort"},),
        ),
        Example(
            Subject(SUBSCRIBE, quantity=_ASKED),
            {"reliability": "best_effort"},
            performed=({"reliability": "reliable"},),
        ),
        Example(
            Subject(SUBSCRIBE, quantity=_ASKED),
            {"reliability": "system_default"},
            away="system_default is neither reliable nor best_effort",
        ),
    )

    def change(self, subject: Subject, value: Value) -> Value:
        return other_of(subject, value)
