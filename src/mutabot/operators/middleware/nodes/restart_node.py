"""restart-node: the node dies and begins anew."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Mishap
from mutabot.model.named import COMING, WRITTEN
from mutabot.operators.middleware._examples import GOAL, TICK
from mutabot.operators.middleware.nodes._mishap import MishapOperator
from mutabot.operators.operator import Example, Subject


class RestartNode(MishapOperator):
    """Kills the process in which the program makes the call, once, and lets it begin anew."""

    name = "restart-node"
    summary = (
        "The node's process is killed in the place of the call and begins anew with the same command line,"
        " as under a supervisor, once. Only where the node is a process of its own."
    )
    rank = 420
    is_raced = True
    mishap = Mishap.RESTARTED
    forms = frozenset({*WRITTEN, *COMING})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(GOAL), performed=({"restarted": 0.0},)),
        Example(Subject(TICK), performed=({"restarted": 0.0},)),
    )

    def fault(self, subject: Subject, what: str) -> str:
        return "the node is killed and begins anew"
