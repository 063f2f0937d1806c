"""What befalls nodes, services, actions and clocks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mutabot.model import Call, Mishap, Proceed, Reply
from mutabot.model.operation import COMING, WRITTEN, Form
from mutabot.model.quantity import Value
from mutabot.operators.operator import Context, Example, Need, Subject, Unchanged

from ._examples import CALL, GOAL, TICK
from .messages import MessageOperator


class _Mishap(MessageOperator):
    """Lets a mishap befall a call, wherever it can.

    Class attributes:
        mishap: what befalls it.
        variants: a mutant each, with the seconds that the mishap takes.
        once: whether it befalls only the first call of a test.
    """

    needs = frozenset({Need.PROGRAM})
    variants: ClassVar[Mapping[str, Any]] = {"": 0.0}
    mishap: ClassVar[Mishap]

    once: ClassVar[bool] = False

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        why = call.cannot(self.mishap) or ("it has happened already" if context.memory else "")
        if why:
            raise Unchanged(why)
        if self.once:
            context.memory.append(True)
        return await proceed(call.with_mishap(self.mishap, context.option))


class KillNode(_Mishap):
    """The node's process is killed in the place of the call, and nobody tells the others. Only where the node
    is a process of its own: never that of the tests.
    """

    name = "kill-node"
    rank = 410
    is_raced = True
    mishap = Mishap.KILLED
    forms = frozenset({*WRITTEN, *COMING})
    fault = "the node is killed"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(GOAL), performed=({"killed": 0.0},)),
        Example(Subject(TICK), performed=({"killed": 0.0},)),
    )


class RestartNode(_Mishap):
    """The node's process is killed in the place of the call and begins anew with the same command line, as
    under a supervisor, once. Only where the node is a process of its own.
    """

    name = "restart-node"
    rank = 420
    is_raced = True
    mishap = Mishap.RESTARTED
    forms = frozenset({*WRITTEN, *COMING})
    fault = "the node is killed and begins anew"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(GOAL), performed=({"restarted": 0.0},)),
        Example(Subject(TICK), performed=({"restarted": 0.0},)),
    )


class CancelGoal(_Mishap):
    """Somebody cancels the action as soon as its goal is sent."""

    name = "cancel-goal"
    rank = 430
    mishap = Mishap.CANCELLED
    forms = frozenset({Form.GOAL})
    fault = "each {what} is cancelled as soon as it is sent"
    examples: ClassVar[tuple[Example, ...]] = (Example(Subject(GOAL), performed=({"cancelled": 0.0},)),)


class JumpClock(_Mishap):
    """The node's clock jumps 10 s ahead, or 10 s back, before a tick of its timer or a turn of its rate."""

    name = "jump-clock"
    rank = 450
    needs = frozenset({Need.MEMORY, Need.COPIES, Need.PROGRAM})
    mishap = Mishap.JUMPED
    forms = frozenset({Form.TICK, Form.SLEEP})
    once = True
    variants: ClassVar[Mapping[str, float]] = {"10": 10.0, "-10": -10.0}
    fault = "the clock jumps 10 s {way} before the first {what}"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(TICK, variant="10"), performed=({"jumped": 10.0},)),
        Example(Subject(TICK, variant="10"), earlier=({},), away="it has happened already"),
    )

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        way = "back" if subject.variant.startswith("-") else "ahead"
        return self.words(subject, way=way)


class LoseAnswer(MessageOperator):
    """A service does what it is asked for, but the program hears of a failure, or never of anything, as its
    middleware has it when an answer is lost.
    """

    name = "lose-answer"
    rank = 440
    forms = frozenset({Form.CALL, Form.GOAL})
    fault = "the answer to each {what} is lost"
    examples: ClassVar[tuple[Example, ...]] = (Example(Subject(CALL), performed=({},), lost=True),)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        return (await proceed(call)).never()
