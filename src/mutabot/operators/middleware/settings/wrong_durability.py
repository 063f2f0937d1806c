"""wrong-durability: what was published before is there for who comes later, or is not."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import ADVERTISE, SUBSCRIBE, setting_of
from mutabot.operators.middleware._values import SettingOperator, other_of
from mutabot.operators.operator import Example, Subject

_OFFERED = setting_of(ADVERTISE, "durability")
_ASKED = setting_of(SUBSCRIBE, "durability")


class WrongDurability(SettingOperator):
    """Swaps volatile and transient local."""

    name = "wrong-durability"
    summary = (
        "A publisher or subscription is volatile instead of transient local, or the other way round. A "
        "subscription that asks for more than is offered hears nothing."
    )
    rank = 350
    setting = "durability"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(ADVERTISE, quantity=_OFFERED),
            {"durability": "transient_local"},
            performed=({"durability": "volatile"},),
        ),
        Example(
            Subject(SUBSCRIBE, quantity=_ASKED),
            {"durability": "volatile"},
            performed=({"durability": "transient_local"},),
        ),
        Example(
            Subject(SUBSCRIBE, quantity=_ASKED),
            {"durability": "system_default"},
            away="system_default is neither volatile nor transient_local",
        ),
    )

    def change(self, subject: Subject, value: Value) -> Value:
        return other_of(subject, value)
