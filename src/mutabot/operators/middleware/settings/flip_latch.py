"""flip-latch: what was published last is kept for who comes later, or is not."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import ADVERTISE, setting_of
from mutabot.operators.middleware._values import Away, SettingOperator
from mutabot.operators.operator import Example, Subject

_LATCH = setting_of(ADVERTISE, "latch")


class FlipLatch(SettingOperator):
    """Latches what is not latched, and the other way round."""

    name = "flip-latch"
    summary = (
        "A publisher that keeps its last message for subscribers who come later does not, or one that does"
        " not does."
    )
    rank = 330
    setting = "latch"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(ADVERTISE, quantity=_LATCH), {"latch": True}, performed=({"latch": False},)),
        Example(Subject(ADVERTISE, quantity=_LATCH), {"latch": False}, performed=({"latch": True},)),
        Example(
            Subject(ADVERTISE, quantity=_LATCH), {"name": "target"}, away="its middleware latches nothing"
        ),
    )

    def change(self, subject: Subject, value: Value) -> Value:
        if not isinstance(value, bool):
            raise Away(f"{value} is neither true nor false")
        return not value
