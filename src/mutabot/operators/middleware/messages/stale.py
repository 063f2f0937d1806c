"""stale: an old message comes in the place of the new one."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Middleware, Proceed, Reply
from mutabot.model.named import Form
from mutabot.operators.middleware._examples import CALL_TO, PUBLISH, RECEIVE
from mutabot.operators.middleware._forms import FormOperator, form_of
from mutabot.operators.operator import Example, Subject

_FIRST = "first"
_PREVIOUS = "previous"
_NONE_BEFORE = "there is none before it"
_WRITTEN = frozenset({Form.PUBLISH, Form.GOAL, Form.CALL})


class Stale(FormOperator):
    """Sends or receives an earlier message instead."""

    name = "stale"
    summary = (
        "An old message is sent, or received, in the place of the new one: always the first, or always the"
        " previous."
    )
    rank = 130
    remembers = True
    forms = _WRITTEN | {Form.RECEIVE, Form.FEEDBACK, Form.TRANSFORM}
    variants = (_FIRST, _PREVIOUS)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(RECEIVE, variant=_FIRST),
            replied={"gap": 0.02},
            earlier=({"gap": 0.5}, {"gap": 0.3}),
            performed=({},),
            received={"gap": 0.5},
            note="a sensor that is stuck",
        ),
        Example(
            Subject(PUBLISH, variant=_PREVIOUS),
            {"x": 0.4},
            earlier=({"x": 0.2}, {"x": 0.3}),
            performed=({"x": 0.3},),
            note="always one behind",
        ),
        Example(
            Subject(CALL_TO, variant=_FIRST),
            {"x": 0.4},
            earlier=({"x": 0.2}, {"x": 0.3}),
            performed=({"x": 0.2},),
            note="the service is asked for the same over and over",
        ),
        Example(Subject(PUBLISH, variant=_FIRST), {"x": 0.4}, away=_NONE_BEFORE),
        Example(Subject(RECEIVE, variant=_PREVIOUS), replied={"gap": 0.02}, earlier=(), away=_NONE_BEFORE),
    )

    def least_calls(self, subject: Subject) -> int:
        return 2

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        writes = form_of(subject.operation) in _WRITTEN
        is_first = subject.variant == _FIRST
        earlier_call: Call | None = None
        earlier_reply: Reply | None = None

        async def sent(call: Call, proceed: Proceed) -> Reply:
            nonlocal earlier_call
            old = earlier_call
            if old is None or not is_first:
                earlier_call = call
            return await proceed(old if old is not None else call.as_is(_NONE_BEFORE))

        async def read(call: Call, proceed: Proceed) -> Reply:
            nonlocal earlier_reply
            reply, old = await proceed(call), earlier_reply
            if old is None or not is_first:
                earlier_reply = reply
            return old if old is not None else reply.as_is(_NONE_BEFORE)

        return sent if writes else read

    def fault(self, subject: Subject, what: str) -> str:
        return f"the {subject.variant} {what} again instead of the new one"
