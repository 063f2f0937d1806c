"""short-queue: a queue holds one message only."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import ADVERTISE, SUBSCRIBE, setting_of
from mutabot.operators.middleware._values import SettingOperator
from mutabot.operators.operator import Example, Subject


class ShortQueue(SettingOperator):
    """Sets up a queue of depth 1."""

    name = "short-queue"
    summary = (
        "The queue of a publisher or subscription holds one message, so that the next one pushes it out."
    )
    rank = 320
    setting = "depth"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(SUBSCRIBE, quantity=setting_of(SUBSCRIBE, "depth")),
            {"name": "gap", "depth": 10},
            performed=({"name": "gap", "depth": 1},),
        ),
        Example(
            Subject(ADVERTISE, quantity=setting_of(ADVERTISE, "depth")),
            {"name": "target", "depth": 1},
            away="the value would stay the same",
        ),
    )

    def change(self, subject: Subject, value: Value) -> Value:
        return 1
