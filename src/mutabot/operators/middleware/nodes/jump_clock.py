"""jump-clock: the program's clock jumps."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Mishap
from mutabot.model.named import Form
from mutabot.operators.middleware._examples import TICK
from mutabot.operators.middleware.nodes._mishap import MishapOperator
from mutabot.operators.operator import Example, Subject

_JUMPS = {"10": 10.0, "-10": -10.0}


class JumpClock(MishapOperator):
    """Sets the clock once, before the first call."""

    name = "jump-clock"
    summary = (
        "The node's clock jumps 10 s ahead, or 10 s back, before a tick of its timer or a turn of its rate."
    )
    rank = 450
    remembers = True
    mishap = Mishap.JUMPED
    once = True
    forms = frozenset({Form.TICK, Form.SLEEP})
    variants = tuple(_JUMPS)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(TICK, variant="10"), performed=({"jumped": 10.0},)),
        Example(Subject(TICK, variant="10"), earlier=({},), away="it has happened already"),
    )

    def seconds(self, subject: Subject) -> float:
        return _JUMPS[subject.variant]

    def fault(self, subject: Subject, what: str) -> str:
        jump = _JUMPS[subject.variant]
        return f"the clock jumps {abs(jump):g} s {'ahead' if jump > 0 else 'back'} before the first {what}"
