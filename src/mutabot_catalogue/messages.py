"""Faults of messages, requests and goals in transit, and of nodes, services, actions and clocks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, TypeVar

from mutabot.api.faults import CommandOperator, Context, Example, Magnitudes, Need, Subject, Unchanged
from mutabot.api.values import Call, CallFault, Form, Proceed, Reply

from ._examples import CALL, CALL_TO, GOAL, PUBLISH, RECEIVE, TICK
from .values import MIDDLEWARE, comes_by_itself

CallOrReply = TypeVar("CallOrReply", Call, Reply)
_THIRD, _CHANCE = "every-3rd", "30%"
_PROBABILITY = 0.3
_FIRST, _PREVIOUS = "first", "previous"
_NONE_BEFORE = "no call came before it"
_EARLIER = frozenset({Need.MEMORY, Need.COPIES})
#: forms that write a message
_SENT = frozenset({Form.PUBLISH, Form.CALL, Form.GOAL})
#: forms of what comes by itself
_COMING = frozenset(form for form in Form if form.comes_by_itself)


class MessageOperator(CommandOperator):
    """Acts on whole calls of certain forms.

    Class attributes:
        forms: the forms.
    """

    family = MIDDLEWARE
    forms: ClassVar[frozenset[Form]]

    def fits(self, whole: Subject) -> bool:
        return whole.operation.form in self.forms


class Drop(MessageOperator):
    """A message, request, goal or result is lost, or a timer does not tick: each, every third, or with a
    probability of 30 %.
    """

    name = "drop"
    needs = _EARLIER
    forms = _SENT | _COMING | {Form.RESULT}
    variants: ClassVar[Mapping[str, str]] = {
        "": "each",
        _THIRD: "every third",
        _CHANCE: "with a probability of 30 %, a",
    }
    fault = "{which} {what} is lost"
    examples = (
        Example.whole(PUBLISH, 0.4),
        Example.whole(RECEIVE, 0.02, lost=True),
        Example.whole(CALL, {}, lost=True),
        Example.whole(PUBLISH, 0.4, variant=_THIRD, earlier=(0.2, 0.3)),
        Example.whole(PUBLISH, 0.3, variant=_THIRD, earlier=(0.2,), away="only the second"),
    )

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        return self.fault_text(subject, which=self.variants[subject.variant])

    def least_calls(self, subject: Subject) -> int:
        return 3 if subject.variant else 1

    def is_chance(self, subject: Subject) -> bool:
        return subject.variant == _CHANCE

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        if not self._is_meant(context):
            return await proceed(call)
        form = call.operation.form
        if form not in _SENT:  # the middleware has the message already when it is lost
            return (await proceed(call)).never()
        return Reply() if form is Form.PUBLISH else Reply().never()

    def _is_meant(self, context: Context) -> bool:
        if context.subject.variant == _CHANCE:
            return context.random.random() < _PROBABILITY
        return context.subject.variant != _THIRD or context.number % 3 == 0


class Duplicate(MessageOperator):
    """A message, request or goal arrives twice, a callback is called twice."""

    name = "duplicate"
    forms = _SENT | _COMING
    fault = "each {what} arrives twice"
    examples = (
        Example.whole(PUBLISH, 0.4, 0.4, 0.4),
        Example.whole(RECEIVE, 0.02, 0.02, then=(0.02,)),
        Example.whole(CALL, {}, {}, {}),
    )

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        reply = await proceed(call)
        return reply.followed_by(reply) if comes_by_itself(call.operation) else await proceed(call)


class Stale(MessageOperator):
    """The first or the previous message is sent, or received, in the place of the new one."""

    name = "stale"
    calls = 2
    needs = _EARLIER
    forms = _SENT | {Form.RECEIVE, Form.FEEDBACK, Form.TRANSFORM}
    variants: ClassVar[Mapping[str, None]] = {_FIRST: None, _PREVIOUS: None}
    fault = "the {variant} {what} again instead of the new one"
    examples = (
        Example.whole(RECEIVE, 0.02, 0.5, variant=_FIRST, earlier=(0.5, 0.3)),
        Example.whole(PUBLISH, 0.4, 0.3, variant=_PREVIOUS, earlier=(0.2, 0.3)),
        Example.whole(CALL_TO, 0.4, 0.2, variant=_FIRST, earlier=(0.2, 0.3)),
        Example.whole(PUBLISH, 0.4, variant=_FIRST, away=_NONE_BEFORE),
        Example.whole(RECEIVE, 0.02, variant=_PREVIOUS, away=_NONE_BEFORE),
    )

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        if call.operation.form in _SENT:
            return await proceed(self._old(call, context))
        return self._old(await proceed(call), context)

    def _old(self, call_or_reply: CallOrReply, context: Context) -> CallOrReply:
        """Return the earlier message, or the present one with the reason why there is none."""
        old = context.memory[0] if context.memory else call_or_reply.as_is(_NONE_BEFORE)
        if not context.memory or context.subject.variant != _FIRST:
            context.memory[:] = [call_or_reply]
        return old


class Delay(MessageOperator):
    """A message, request, goal, result or transform comes 0.1 s or 1 s late; later messages may overtake a
    received one.
    """

    name = "delay"
    forms = _SENT | _COMING | {Form.RESULT, Form.TRANSFORM, Form.SLEEP}
    fault = "each {what} comes {variant} s late"
    examples = (
        Example.whole(PUBLISH, 0.4, {"x": 0.4, "late": 0.1}, size=(0.1, None)),
        Example.whole(CALL, {}, {"late": 1.0}, size=(1.0, None)),
        Example.whole(RECEIVE, 0.02, 0.02, size=(1.0, None), late=1.0),
    )

    def magnitudes(self, whole: Subject) -> Magnitudes | None:
        return Magnitudes(None, (0.1, 1.0))  # seconds: a network that is busy, and one that has trouble

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        seconds = context.subject.magnitude or 0.0
        why = call.cannot(CallFault.LATE)
        if why:
            raise Unchanged(why)
        if call.operation.form in _SENT:
            return await proceed(call.with_call_fault(CallFault.LATE, seconds))
        return (await proceed(call)).later(seconds)


class Reorder(MessageOperator):
    """Messages change places, two by two. A last one alone is lost."""

    name = "reorder"
    calls = 2
    needs = _EARLIER
    forms = frozenset({Form.PUBLISH, Form.RECEIVE, Form.FEEDBACK})
    fault = "every other {what} comes after the next one"
    examples = (
        Example.whole(PUBLISH, 0.4, 0.4, 0.2, earlier=(0.2,)),
        Example.whole(PUBLISH, 0.2),
        Example.whole(RECEIVE, 0.02, 0.02, earlier=(0.5,), then=(0.5,)),
        Example.whole(RECEIVE, 0.5, lost=True),
    )

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        held = context.memory
        if call.operation.form is not Form.PUBLISH:
            reply = await proceed(call)
            if held:
                return reply.followed_by(held.pop())
            held.append(reply)
            return reply.never()
        if not held:
            held.append(call)
            return Reply()
        old = held.pop()
        reply = await proceed(call)
        await proceed(old)
        return reply


class _Mishap(MessageOperator):
    """Applies a fault to a call, wherever it can.

    Class attributes:
        call_fault: what befalls it.
        variants: a mutant each, with the seconds that the fault takes.
        once: whether it befalls only the first call of a test.
    """

    needs = frozenset({Need.PROGRAM})
    variants: ClassVar[Mapping[str, Any]] = {"": 0.0}
    call_fault: ClassVar[CallFault]

    once: ClassVar[bool] = False

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        why = call.cannot(self.call_fault) or ("it has happened already" if context.memory else "")
        if why:
            raise Unchanged(why)
        if self.once:
            context.memory.append(True)
        return await proceed(call.with_call_fault(self.call_fault, context.option))


class _ProcessDeath(_Mishap):
    is_raced = True
    forms = _SENT | _COMING


def _dead(how: str) -> tuple[Example, ...]:
    return tuple(Example(Subject(operation), performed=({how: 0.0},)) for operation in (GOAL, TICK))


class KillNode(_ProcessDeath):
    """The node's process is killed at the call, if it is not that of the tests."""

    name = "kill-node"
    call_fault = CallFault.KILLED
    fault = "the node is killed"
    examples = _dead("killed")


class RestartNode(_ProcessDeath):
    """The node's process is killed at the call and begins anew with the same command line, once, if it is
    not that of the tests.
    """

    name = "restart-node"
    call_fault = CallFault.RESTARTED
    fault = "the node is killed and begins anew"
    examples = _dead("restarted")


class CancelGoal(_Mishap):
    """The action is cancelled as soon as its goal is sent."""

    name = "cancel-goal"
    call_fault = CallFault.CANCELLED
    forms = frozenset({Form.GOAL})
    fault = "each {what} is cancelled as soon as it is sent"
    examples = (Example(Subject(GOAL), performed=({"cancelled": 0.0},)),)


class JumpClock(_Mishap):
    """The node's clock jumps 10 s ahead or back before a tick of its timer or a turn of its rate."""

    name = "jump-clock"
    needs = frozenset({Need.MEMORY, Need.COPIES, Need.PROGRAM})
    call_fault = CallFault.JUMPED
    forms = frozenset({Form.TICK, Form.SLEEP})
    once = True
    variants: ClassVar[Mapping[str, float]] = {"10": 10.0, "-10": -10.0}
    fault = "the clock jumps 10 s {way} before the first {what}"
    examples = (
        Example(Subject(TICK, variant="10"), performed=({"jumped": 10.0},)),
        Example(Subject(TICK, variant="10"), earlier=({},), away="it has happened already"),
    )

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        way = "back" if subject.variant.startswith("-") else "ahead"
        return self.fault_text(subject, way=way)


class LoseAnswer(MessageOperator):
    """A service does its work, but the program hears of a failure, or never of anything."""

    name = "lose-answer"
    forms = frozenset({Form.CALL, Form.GOAL})
    fault = "the answer to each {what} is lost"
    examples = (Example(Subject(CALL), performed=({},), lost=True),)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        return (await proceed(call)).never()
