"""wrong-name: a topic, service or action is looked for under another name."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model.values.quantity import Value
from mutabot.operators.middleware._examples import ADVERTISE, CLIENT, SUBSCRIBE, setting_of
from mutabot.operators.middleware._values import Away, SettingOperator
from mutabot.operators.operator import Example, Subject

_MISSPELT = "misspelt"
_GLOBAL = "global"


class WrongName(SettingOperator):
    """Gives another name."""

    name = "wrong-name"
    summary = (
        "A publisher, subscription or client is set up under another name: one that nobody else has, or "
        "without the namespace of its node, as a wrong remapping does."
    )
    rank = 310
    setting = "name"
    variants = (_MISSPELT, _GLOBAL)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(SUBSCRIBE, quantity=setting_of(SUBSCRIBE, "name"), variant=_MISSPELT),
            {"name": "gap"},
            performed=({"name": "gap_misspelt"},),
        ),
        Example(
            Subject(ADVERTISE, quantity=setting_of(ADVERTISE, "name"), variant=_GLOBAL),
            {"name": "target"},
            performed=({"name": "/target"},),
            note="the node stands in the namespace /arm",
        ),
        Example(
            Subject(CLIENT, quantity=setting_of(CLIENT, "name"), variant=_GLOBAL),
            {"name": "/arm/follow"},
            away="its name is a global one",
        ),
        Example(
            Subject(SUBSCRIBE, quantity=setting_of(SUBSCRIBE, "name"), variant=_GLOBAL),
            {"name": "gap"},
            away="its node has no namespace",
        ),
    )

    def change(self, subject: Subject, value: Value) -> Value:
        if subject.variant == _MISSPELT:
            return f"{value}_misspelt"
        if str(value).startswith("/"):
            raise Away("its name is a global one")
        changed = "/" + str(value).removeprefix("~").removeprefix("/")
        named = subject.operation.named
        if named is not None and named.name == changed:
            raise Away("its node has no namespace")
        return changed
