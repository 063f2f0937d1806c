"""wrong-period: a timer or rate has another period."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import RATE, TIMER, setting_of
from mutabot.operators.middleware._values import Away, SettingOperator
from mutabot.operators.operator import Example, Subject, is_number

_FACTORS = {"x2": 2.0, "x0.5": 0.5}
_OF_TIMER = setting_of(TIMER, "period")
_OF_RATE = setting_of(RATE, "period")


class WrongPeriod(SettingOperator):
    """Doubles or halves the period."""

    name = "wrong-period"
    summary = "A timer or rate has twice the period, or half of it."
    rank = 370
    setting = "period"
    variants = tuple(_FACTORS)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(TIMER, quantity=_OF_TIMER, variant="x2"), {"period": 0.1}, performed=({"period": 0.2},)
        ),
        Example(
            Subject(RATE, quantity=_OF_RATE, variant="x0.5"), {"period": 0.1}, performed=({"period": 0.05},)
        ),
        Example(Subject(TIMER, quantity=_OF_TIMER, variant="x2"), {"period": 0.0}, away="it has no period"),
    )

    def change(self, subject: Subject, value: Value) -> Value:
        if not is_number(value) or not value:
            raise Away("it has no period")
        return value * _FACTORS[subject.variant]
