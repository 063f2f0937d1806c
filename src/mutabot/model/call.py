"""Calls and replies as operators see them: quantities and their values, nothing of Python syntax."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.model.values.quantity import Quantity, Value

from .operation import Operation, Pattern


async def _unknown(quantity: Quantity) -> float:
    raise LookupError(f"no reading tells where {quantity.name} is now")


@dataclass(frozen=True, slots=True)
class Reply:
    """What an operation answered, with the values it reads.

    Attributes:
        values: value of each read quantity by name, in the quantity's unit.
        payload: the result object itself; operators never look inside.
        away: why the operator left it as it is; empty if it does not say so.
    """

    values: Mapping[str, Value] = field(default_factory=dict)
    payload: Any = None
    away: str = ""

    def with_value(self, quantity: Quantity, value: Value) -> Reply:
        """The same reply with another value for one quantity."""
        return replace(self, values={**self.values, quantity.name: value})

    def as_is(self, why: str) -> Reply:
        """The same reply, with the reason why the operator leaves it alone."""
        return replace(self, away=why)


@dataclass(frozen=True, slots=True)
class Call:
    """One invocation of an operation, with the values it writes.

    Attributes:
        operation: what is invoked.
        pattern: which text command it is; None for operations that are not text, or for a command the
            vocabulary does not know.
        values: value of each written quantity by name, in the quantity's unit. A quantity that is absent
            in this call (an omitted part, None) is missing here.
        reversed: whether the opposite of the operation or pattern is to be done.
        current: tells where a written quantity is now, in that quantity's unit; raises LookupError when
            the vocabulary names no such reading.
        idle: what the operation answers while the robot does nothing; None unless the operator has declared
            that it asks (``asks_idle``).
        payload: what the door needs to perform the call; operators never look inside.
        away: why the operator left it as it is; empty if it does not say so.
    """

    operation: Operation
    pattern: Pattern | None = None
    values: Mapping[str, Value] = field(default_factory=dict)
    reversed: bool = False
    current: Callable[[Quantity], Awaitable[float]] = _unknown
    idle: Reply | None = None
    payload: Any = None
    away: str = ""

    @property
    def is_command(self) -> bool:
        """Whether the robot is made to do something."""
        if self.pattern is not None and self.pattern.command is not None:
            return self.pattern.command
        return self.operation.command

    def with_value(self, quantity: Quantity, value: Value) -> Call:
        """The same call with another value for one quantity."""
        return replace(self, values={**self.values, quantity.name: value})

    def as_is(self, why: str) -> Call:
        """The same call, with the reason why the operator leaves it alone."""
        return replace(self, away=why)

    def opposite(self) -> Call:
        """The call of the opposite operation or text command, with the same values."""
        return replace(self, reversed=not self.reversed)


#: Performs the original operation.
Proceed = Callable[[Call], Awaitable[Reply]]
#: A mutant at work: ``mutated(call, proceed) -> reply``. It is a coroutine function so that one text
#: serves plain and async operations alike.
Middleware = Callable[[Call, Proceed], Awaitable[Reply]]
