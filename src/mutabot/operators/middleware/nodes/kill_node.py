"""kill-node: the node dies."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Mishap
from mutabot.model.named import COMING, WRITTEN
from mutabot.operators.middleware._examples import GOAL, TICK
from mutabot.operators.middleware.nodes._mishap import MishapOperator
from mutabot.operators.operator import Example, Subject


class KillNode(MishapOperator):
    """Kills the process in which the program makes the call."""

    name = "kill-node"
    summary = (
        "The node's process is killed in the place of the call, and nobody tells the others. Only where "
        "the node is a process of its own: never that of the tests."
    )
    rank = 410
    is_raced = True
    mishap = Mishap.KILLED
    forms = frozenset({*WRITTEN, *COMING})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(GOAL), performed=({"killed": 0.0},)),
        Example(Subject(TICK), performed=({"killed": 0.0},)),
    )

    def fault(self, subject: Subject, what: str) -> str:
        return "the node is killed"
