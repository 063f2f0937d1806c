"""Calls and replies as operators see them, in quantities and their values; and the seeds of randomness."""

from __future__ import annotations

import hashlib
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

from mutabot.model.operation import Operation, Pattern
from mutabot.model.quantity import Quantity, Value


class CallFault(StrEnum):
    """Faults of the middleware that can happen to a named call, such as loss or delay.

    An operator that wants one first asks ``call.cannot(call_fault)``.
    """

    #: it is carried out this many seconds of the program's clock later. The program waits for it only where
    #: it
    #: waits for an answer: what is published goes out by itself
    LATE = "late"
    #: what it begins is cancelled at once
    CANCELLED = "cancelled"
    #: the process that makes it is killed in its stead
    KILLED = "killed"
    #: the process that makes it is killed in its stead, and begins anew; this happens once
    RESTARTED = "restarted"
    #: before it is made, the program's clock jumps by this many seconds
    JUMPED = "jumped"


class Unchanged(Exception):  # noqa: N818  # no error: a reason
    """Raised if an operator leaves a call, or what it reads, unchanged; the text says why."""


def _unavailable(why: str) -> Callable[..., Any]:
    """Return a placeholder for a function that is not available, which raises LookupError with a reason."""

    def raises(*_: object) -> Any:
        raise LookupError(why)

    return raises


_NO_READING = _unavailable("no reading gives the robot's present position")
_NO_CLOCK = _unavailable("the time of the simulation is unknown")
_NO_WAIT = _unavailable("nothing lets the program's time pass")
_NO_PREVIOUS = _unavailable("the arguments of the call before this one are not known")
NO_DEFER = _unavailable("nothing here can make a call later")


@dataclass(frozen=True, slots=True)
class Reply:
    """The answer of an operation, with the values it reads.

    A message to a callback (see ``Form.comes_by_itself``) may also come later, several times or not at all.
    An answer that the program waits for may come later or not at all.

    Attributes:
        values: value of each read quantity by name, in the quantity's unit.
        payload: the result object itself; operators never look inside.
        away: why the operator left it as it is; empty if it does not say so.
        late: seconds of the program's clock by which the program gets it later.
        lost: whether the program never gets it.
        more: what comes after it, of what comes by itself.
        error: the exception (``module:Name``) that the program gets in its stead; empty if it gets the reply.
    """

    values: Mapping[str, Value] = field(default_factory=dict)
    payload: Any = None
    away: str = ""
    late: float = 0.0
    lost: bool = False
    more: tuple[Reply, ...] = ()
    error: str = ""

    def with_value(self, quantity: Quantity, value: Value) -> Reply:
        """Return a copy of the reply with another value for one quantity."""
        return replace(self, values={**self.values, quantity.name: value})

    def as_is(self, why: str) -> Reply:
        """Return the same reply, with the reason why the operator leaves it unchanged."""
        return replace(self, away=why)

    def later(self, seconds: float) -> Reply:
        """Return a copy of the reply that comes later by this time (s)."""
        return replace(self, late=self.late + seconds)

    def never(self) -> Reply:
        """Return a copy of the reply that never reaches the program."""
        return replace(self, lost=True)

    def failing(self, error: str) -> Reply:
        """Return a copy of the reply that raises this exception in the program (``module:Name``)."""
        return replace(self, error=error)

    def followed_by(self, *others: Reply) -> Reply:
        """Return a copy of the reply that is followed by these."""
        return replace(self, more=(*self.more, *others))

    @property
    def parts(self) -> tuple[Reply, ...]:
        """All replies that the program gets, in this order."""
        return (*(() if self.lost else (self,)), *(part for reply in self.more for part in reply.parts))

    @property
    def comes_as_usual(self) -> bool:
        """Whether the program gets it exactly once and without delay."""
        return not (self.late or self.lost or self.more or self.error)


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
        current: returns where a written quantity is now, in that quantity's unit; raises LookupError when
            the vocabulary names no such reading, and Unchanged if that has returned nothing yet.
        idle: what the operation answers while the robot does nothing; None unless the operator has declared
            that it asks (``Need.IDLE``).
        payload: what the adapter needs to perform the call; operators never look inside.
        away: why the operator left it as it is; empty if it does not say so.
        call_faults: what befalls it, with seconds where it takes some.
        cannot: why something cannot befall it here; empty if it can.
        time: simulated seconds since the test's first tick; raises LookupError without a clock.
        wait: lets a number of seconds pass on the program's clock; raises LookupError where nothing says how.
        previous: what the program's call of this operation, or text command, before this one wrote; None if
            there was none in this test. Raises LookupError where that is unknown.
        defer: has a call made right after the program's next command; never if none follows. While one is
            due, the operator is not asked: the next call at its site is made as it is.
        is_refusal: whether an exception is one by which the robot refuses a command.
    """

    operation: Operation
    pattern: Pattern | None = None
    values: Mapping[str, Value] = field(default_factory=dict)
    reversed: bool = False
    current: Callable[[Quantity], Awaitable[float]] = _NO_READING
    idle: Reply | None = None
    payload: Any = None
    away: str = ""
    call_faults: Mapping[CallFault, float] = field(default_factory=dict)
    cannot: Callable[[CallFault], str] = lambda call_fault: ""
    time: Callable[[], float] = _NO_CLOCK
    wait: Callable[[float], Awaitable[None]] = _NO_WAIT
    previous: Callable[[], Mapping[str, Value] | None] = _NO_PREVIOUS
    defer: Callable[[Call], None] = NO_DEFER
    is_refusal: Callable[[BaseException], bool] = lambda error: False

    @property
    def is_command(self) -> bool:
        """Whether the call makes the robot do something."""
        if self.pattern is not None and self.pattern.command is not None:
            return self.pattern.command
        return self.operation.command

    @property
    def idle_reply(self) -> Reply:
        """The command's answer if the robot does nothing. Raises LookupError if that is not known."""
        if self.idle is None:
            raise LookupError(f"no answer is known for leaving out {self.operation.name}; give one by `idle`")
        return self.idle

    def with_value(self, quantity: Quantity, value: Value) -> Call:
        """Return a copy of the call with another value for one quantity."""
        return replace(self, values={**self.values, quantity.name: value})

    def with_call_fault(self, call_fault: CallFault, seconds: float = 0.0) -> Call:
        """Return a copy of the call with a fault of the middleware."""
        return replace(self, call_faults={**self.call_faults, call_fault: seconds})

    def as_is(self, why: str) -> Call:
        """Return a copy of the call, with the reason why the operator leaves it alone."""
        return replace(self, away=why)

    def opposite(self) -> Call:
        """Return the call of the opposite operation or text command, with the same values."""
        return replace(self, reversed=not self.reversed)


#: Performs the original operation.
Proceed = Callable[[Call], Awaitable[Reply]]
#: A mutant at work: ``mutated(call, proceed) -> reply``. It is a coroutine function so that one text
#: serves plain and async operations alike.
Middleware = Callable[[Call, Proceed], Awaitable[Reply]]


#: environment variables for tests that run without a campaign: the seed of every test alike; or the number of
#: a round, from 1 as they are printed, and the campaign's seed, which give every test its seed in that round
SEED_VARIABLE, ROUND_VARIABLE, CAMPAIGN_SEED_VARIABLE = (
    "MUTABOT_SEED", "MUTABOT_ROUND", "MUTABOT_CAMPAIGN_SEED",
)  # fmt: skip
#: the campaign's seed unless configuration or command line say otherwise
DEFAULT_SEED = 1


def derive(*parts: object) -> int:
    """Return a whole number of 32 bits that depends on all parts and on nothing else."""
    text = "\x1f".join(str(part) for part in parts)
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=4).digest(), "big")
