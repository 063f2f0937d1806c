"""Run an operator's middleware around a call, and record whether it changed anything.

Middleware is written as a coroutine function. Around a plain operation nothing ever suspends, so one
``send`` runs it to its end; around an async operation it is awaited like any other coroutine.
"""

from __future__ import annotations

from collections.abc import Coroutine, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from mutabot.errors import OperatorError
from mutabot.model import Call, Middleware, Proceed, Quantity, Reply
from mutabot.model.call import NO_DEFER
from mutabot.model.quantity import Value, are_same, changes, same

T = TypeVar("T")


class Carried(BaseException):
    """Wraps an exception that a coroutine must not see: it turns StopIteration into RuntimeError."""

    def __init__(self, error: BaseException) -> None:
        super().__init__(error)
        self.error = error


def run(coroutine: Coroutine[Any, Any, T], *, operator: str) -> T:
    """Return the result of a coroutine that never suspends.

    Raises OperatorError if it does suspend: the operator awaited something other than ``proceed``
    or ``call.current``.
    """
    __tracebackhide__ = True
    try:
        coroutine.send(None)
    except StopIteration as end:
        result: T = end.value
        return result
    except Carried as carried:
        error = carried.error
    else:
        coroutine.close()
        raise OperatorError(
            f"operator {operator!r} waits for something in a plain call; "
            "it may await proceed and call.current only"
        )
    try:
        raise error  # out of the clause, so that it is raised beside no other
    finally:
        del error  # its traceback leads here


@dataclass(slots=True)
class CallRecord:
    """The record of one call that went through a mutant.

    Attributes:
        call: the original call.
        performed: the calls that reached the robot.
        changes: the values of the last of them that are new or differ from those of the original call.
        answered: the robot's answers to them.
        received: what the program received; None while the mutant is still at work.
        waits: seconds of the program's time that the mutant let pass, each time.
        deferred: calls to be made right after the program's next command.
        is_late: whether it is the passage of such a call.
    """

    call: Call
    performed: list[Call] = field(default_factory=list)
    changes: Mapping[str, Value] = field(default_factory=dict)
    answered: list[Reply] = field(default_factory=list)
    received: Reply | None = None
    waits: list[float] = field(default_factory=list)
    deferred: list[Call] = field(default_factory=list)
    is_late: bool = False

    def begins(self, call: Call) -> None:
        """Note a call that is about to reach the robot."""
        self.performed.append(call)
        meant = call.pattern or call.operation
        self.changes = changes(meant.arguments, self.call.values, call.values)

    @property
    def waited(self) -> float:
        """The seconds of the program's time that the mutant waited."""
        return sum(self.waits)

    @property
    def acted(self) -> bool:
        """Whether the mutant changed anything noticeable to the robot or the program, now or later."""
        return self.acted_at_once or bool(self.deferred)

    @property
    def acted_at_once(self) -> bool:
        """Whether it acted immediately, not counting actions that are done later."""
        return self.changed_command or self.changed_reading or self.waited > 0.0

    @property
    def away(self) -> str:
        """Why the mutant changed nothing, if its operator gives a reason."""
        if self.acted or self.received is None:
            return ""
        return self.received.away or (self.performed[-1].away if self.performed else "")

    @property
    def changed_command(self) -> bool:
        """Whether the robot got a command that differs from what the program sent."""
        if self.is_late:
            return True
        if len(self.performed) != 1:
            return bool(self.performed) or self.received is not None
        performed = self.performed[0]
        if performed.reversed != self.call.reversed or performed.call_faults:
            return True
        is_same_rest = same(performed.payload, self.call.payload)
        return not is_same_rest or bool(self.changes) or performed.values.keys() != self.call.values.keys()

    @property
    def changed_reading(self) -> bool:
        """Whether the program got an answer that differs from the robot's."""
        if self.received is None:
            return False
        if not self.answered:  # the robot raised, and the program does not hear of it
            return bool(self.performed)
        answered = self.answered[-1]
        if not self.received.comes_as_usual:
            return True
        meant = self.call.pattern or self.call.operation
        return not (
            same(self.received.payload, answered.payload)
            and are_same(meant.result, self.received.values, answered.values)
        )


def recording(passage: CallRecord, proceed: Proceed) -> Proceed:
    """Return ``proceed`` with a record of the calls that go through it in ``passage``."""

    async def noted(call: Call) -> Reply:
        passage.begins(call)
        reply = await proceed(call)
        passage.answered.append(reply)
        return reply

    return noted


async def run_middleware(
    passage: CallRecord, middleware: Middleware, proceed: Proceed, **known: Any
) -> Reply:
    """Send the passage's call through the mutant.

    What the call holds leads back to none of this: what it was given dies with it.

    Args:
        passage: of the call.
        middleware: the mutant's.
        proceed: performs a call.
        known: what else the call is to know, by the names of its fields.
    """
    wait, waits, deferred = passage.call.wait, passage.waits, passage.deferred

    async def waited(seconds: float) -> None:
        await wait(seconds)
        waits.append(seconds)

    def defer(call: Call) -> None:
        deferred.append(replace(call, defer=NO_DEFER))

    passage.call = replace(passage.call, wait=waited, defer=defer, **known)
    passage.received = await middleware(passage.call, recording(passage, proceed))
    return passage.received


def rehearse(
    middleware: Middleware,
    call: Call,
    replied: Mapping[str, Value],
    *,
    current: Mapping[str, float] | None = None,
    payload: object = None,
    refusal: Exception | None = None,
    operator: str,
) -> CallRecord:
    """Run a recorded call through a mutant, with a robot that always answers ``replied``.

    ``payload`` stands for what is in the reply beside the values: it is unlike any other object.
    ``refusal``: what the robot raises instead of answering, if it does.
    LookupError from ``call.current`` passes through when ``current`` does not say where the robot is.
    """

    async def where(quantity: Quantity) -> float:
        if current is None or quantity.name not in current:
            raise LookupError(f"where {quantity.name} is was not recorded")
        return current[quantity.name]

    async def answer(call: Call) -> Reply:
        if refusal is not None:
            raise refusal
        return Reply(dict(replied), payload)

    passage = CallRecord(replace(call, current=where))
    run(run_middleware(passage, middleware, answer), operator=operator)
    return passage
