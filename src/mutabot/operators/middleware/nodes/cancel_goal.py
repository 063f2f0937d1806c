"""cancel-goal: an action is cancelled as soon as its goal is sent."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Mishap
from mutabot.model.named import Form
from mutabot.operators.middleware._examples import GOAL
from mutabot.operators.middleware.nodes._mishap import MishapOperator
from mutabot.operators.operator import Example, Subject


class CancelGoal(MishapOperator):
    """Sends the goal, and cancels it."""

    name = "cancel-goal"
    summary = "Somebody cancels the action as soon as its goal is sent."
    rank = 430
    mishap = Mishap.CANCELLED
    forms = frozenset({Form.GOAL})
    examples: ClassVar[tuple[Example, ...]] = (Example(Subject(GOAL), performed=({"cancelled": 0.0},)),)

    def fault(self, subject: Subject, what: str) -> str:
        return f"each {what} is cancelled as soon as it is sent"
