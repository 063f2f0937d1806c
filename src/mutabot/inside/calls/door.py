"""Between Python calls and the ``Call`` and ``Reply`` that operators see.

The door binds arguments to the vocabulary's quantities, writes changed values back into copies of the
arguments, performs the call, and does the same with the result. The user's own objects are never changed.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from mutabot.errors import PathError
from mutabot.inside.readings.clock import ProgramTime
from mutabot.inside.targets.target import Means, resolve
from mutabot.model import Call, NotToldError, Operation, Pattern, Quantity, Reply
from mutabot.model.named import Form
from mutabot.model.values.answer import NotKeptError, keep, restore
from mutabot.model.values.quantity import Value, is_reading_of
from mutabot.model.values.sameness import changes, is_same

from .answers import snapshot
from .arguments import Arguments, signature_for
from .callers import Caller
from .mishaps import why_not
from .writer import Message, Writer


def _apply(wrapped: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    return wrapped(*args, **kwargs)


@dataclass(slots=True)
class Invocation:
    """A call as Python made it: the door's payload in ``Call.payload``.

    Attributes:
        wrapped: the original callable, bound.
        instance: the object it is bound to, or None.
        args, kwargs: as the program gave them.
        arguments: the same by name; None if they do not fit the signature.
        message: what says which command it is, or None.
        means: what can befall it; None if nothing can.
        receiver: what it was read from where it is called, if that is known.
        caller: makes calls of callables as the program does.
    """

    wrapped: Callable[..., Any] = field(compare=False)
    instance: Any
    args: tuple[Any, ...]
    kwargs: dict[str, Any]
    arguments: Arguments | None = field(compare=False)
    message: Message | None = field(default=None, compare=False)
    means: Means | None = field(default=None, compare=False)
    receiver: Any = field(default=None, compare=False)
    caller: Caller = field(default=_apply, compare=False)


class Door:
    """Translates the calls of one operation.

    Args:
        operation: the operation.
        readings: the operations that tell where the robot is, by name.
        on_problem: told once about each path that does not fit: (key, error).

    Attributes:
        commands: how often the robot was made to do this, if it does anything.
        calls: how often it was called.
        lately: values that last came by under the names of a middleware, by target; doors share it.
        handles: classes that are part of the robot API: their objects are never copied.
        time: the program's time; None where nothing tells.
    """

    def __init__(
        self,
        operation: Operation,
        readings: Mapping[str, Operation | None],
        on_problem: Callable[[str, PathError], None] = lambda key, error: None,
    ) -> None:
        self.operation = operation
        self._readings = readings
        self._on_problem = on_problem
        self._signature: inspect.Signature | None = None
        self._writer = Writer(operation, on_problem)
        self._last_replies: dict[str | None, Any] = {}
        self._last_written: dict[str | None, dict[str, Value]] = {}
        self.commands = 0
        self.calls = 0
        self.lately: dict[str, Mapping[str, Value]] = {}
        self.handles: Collection[str] = ()
        self.time: ProgramTime | None = None

    def use_signature(self, signature: inspect.Signature) -> None:
        """Read calls by this signature, unless the vocabulary or an earlier call has told another."""
        if self._signature is None and self.operation.signature is None:
            self._signature = signature

    def reset(self) -> None:
        """Forget earlier answers and commands: a new test begins."""
        self._last_replies.clear()
        self._last_written.clear()
        self.lately.clear()
        self.commands = self.calls = 0

    def call(
        self,
        wrapped: Callable[..., Any],
        instance: Any,
        args: tuple[Any, ...],
        kwargs: dict[str, Any],
        means: Means | None = None,
        receiver: Any = None,
        caller: Caller = _apply,
    ) -> Call:
        """The call as operators see it."""
        self.calls += 1
        bound = self._bind(wrapped, args, kwargs)
        invocation = Invocation(wrapped, instance, args, kwargs, bound, None, means, receiver, caller)
        pattern, values = None, dict[str, Value]()
        if invocation.arguments is not None:
            invocation.message = self._writer.message(invocation.arguments, instance)
            pattern, values = self._writer.read(invocation.arguments, instance, invocation.message)

        async def current(quantity: Quantity) -> float:
            return await self._where(quantity, invocation, pattern)

        cannot = partial(why_not, means)
        before = self._last_written.get(_text_of(pattern))
        self._last_written[_text_of(pattern)] = {name: snapshot(value) for name, value in values.items()}
        times: dict[str, Any] = {}
        if self.time is not None:
            times = {"time": self.time.now, "wait": self.time.wait if means is None else means.sleep}
        return Call(
            self.operation, pattern, values, current=current, payload=invocation, cannot=cannot,
            previous=lambda: before, **times,
        )  # fmt: skip

    def perform(self, call: Call, original: Call) -> Any:
        """Do what the call says; returns the operation's own result (an awaitable for async ones)."""
        invocation: Invocation = call.payload
        fits = invocation.arguments is not None or self.operation.signature is not None
        self.commands += call.is_command and fits  # what does not fit never reaches the robot
        if call is original:
            return invocation.caller(invocation.wrapped, invocation.args, invocation.kwargs)
        is_text = call.pattern is not None and call.pattern.notation is not None
        wrapped = self._opposite(call) if call.reversed and not is_text else invocation.wrapped
        meant = call.pattern if call.pattern is not None else self.operation
        changed = changes(meant.arguments, original.values, call.values)
        if invocation.arguments is None or (not changed and not call.reversed):
            return invocation.caller(wrapped, invocation.args, invocation.kwargs)
        args, kwargs = self._writer.changed(call, changed, invocation.arguments, invocation.message)
        return invocation.caller(wrapped, args, kwargs)

    def reply(self, call: Call, result: Any) -> Reply:
        """The reply as operators see it."""
        self._refuse_coroutine(result)
        self._refuse_signature(call.payload)
        meant = call.pattern if call.pattern is not None else self.operation
        values = self._read(meant.result, result)
        if call.is_command:
            self._last_replies[_text_of(call.pattern)] = snapshot(result)
        if self.operation.named is not None:
            self.lately[self.operation.target] = {**call.values, **values}
        return Reply(values, result)

    def _read(self, quantities: tuple[Quantity, ...], result: Any) -> dict[str, Value]:
        """The values that are read from a result."""
        values: dict[str, Value] = {}
        for quantity in quantities:
            try:
                value = quantity.get(result)
            except PathError as error:
                self._on_problem(f"result.{quantity.name}", error)
                continue
            if value is not None:
                values[quantity.name] = value
        return values

    def hear(self, name: str, message: Any) -> None:
        """A message came by that the program may receive without a call of this operation at any site."""
        named = self.operation.named
        if named is not None and named.node is None and named.fits(Form.RECEIVE, name, None):
            self.lately[self.operation.target] = self._read(self.operation.result, message)

    def result(self, call: Call, reply: Reply, original: Reply | None) -> Any:
        """What the program receives: the result itself, or a copy with changed values."""
        result = reply.payload
        before: Mapping[str, Value] = original.values if original is not None else {}
        for quantity in call.pattern.result if call.pattern is not None else self.operation.result:
            if quantity.name in reply.values:
                value = reply.values[quantity.name]
                if not is_same(quantity, value, before.get(quantity.name)):
                    result = quantity.put(result, _typed_like(value, before.get(quantity.name)))
        return result

    def _refuse_coroutine(self, result: Any) -> None:
        """A plain function that hands out a coroutine has done nothing yet: it cannot be mutated in place."""
        if inspect.iscoroutine(result):
            text = f"{self.operation.target} returns a coroutine but is no coroutine function"
            error = PathError(
                f"{text}; name the coroutine function behind it", path="", step="call", found="coroutine"
            )
            self._on_problem("call", error)

    def _refuse_signature(self, invocation: Invocation) -> None:
        """A call that went well, although the vocabulary's signature does not take it."""
        if invocation.arguments is None and self.operation.signature is not None:
            given = [*("…" for _ in invocation.args), *(f"{name}=…" for name in invocation.kwargs)]
            text = f"{self.operation.signature} does not take the call ({', '.join(given)})"
            self._on_problem("signature", PathError(text, path="", step="", found=""))

    def _bind(
        self, wrapped: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> Arguments | None:
        if self._signature is None:
            self._signature = signature_for(self.operation.signature, wrapped)
        return Arguments.of(self._signature, args, kwargs)  # None: the call itself will say what is wrong

    def _opposite(self, call: Call) -> Callable[..., Any]:
        target = call.pattern.opposite if call.pattern is not None else self.operation.opposite
        assert target is not None
        opposite: Callable[..., Any] = self._other(target, call.payload)
        return opposite

    def _other(self, target: str, invocation: Invocation) -> Any:
        """Another attribute of the same object, or of its module where that is not possible."""
        module, _, qualname = target.partition(":")
        name = qualname.rpartition(".")[2]
        instance, receiver = invocation.instance, invocation.receiver
        if instance is not None and "." in qualname and hasattr(type(instance), name):
            return getattr(instance, name)
        found = getattr(receiver, name, None)  # of a mock, or of what stands in for a module
        if receiver is not None and found is not None:
            return found
        owner, name, _ = resolve(sys.modules[module], qualname)
        return getattr(owner, name)

    async def _where(self, quantity: Quantity, invocation: Invocation, pattern: Pattern | None) -> float:
        own = pattern.current if pattern is not None else None
        reading = self._readings.get(own or self.operation.current or "")
        if reading is None:
            raise LookupError(f"{self.operation.target} names no reading that tells where {quantity.name} is")
        if reading.named is not None:
            return self._lately_at(reading, quantity)
        value = self._other(reading.target, invocation)
        if callable(value):
            value = value()
        if inspect.isawaitable(value):
            value = await value
        for part in reading.result:
            if is_reading_of(part, quantity):
                number = part.path.get(value)
                return quantity.from_unit(float(number), part.unit) if part.unit else float(number)
        raise NotToldError(f"{reading.target} does not read the {quantity.axis} of a {quantity.kind}")

    def _lately_at(self, reading: Operation, quantity: Quantity) -> float:
        """Where a quantity is by what came last under a name: the program knows no better."""
        for part in reading.readings:
            if is_reading_of(part, quantity):
                number = self.lately.get(reading.target, {}).get(part.name)
                if number is None:
                    raise NotToldError(f"nothing has come yet of {reading.target}")
                return quantity.from_unit(float(number), part.unit) if part.unit else float(number)
        raise NotToldError(f"{reading.target} does not read the {quantity.axis} of a {quantity.kind}")

    def last_answer(self, call: Call) -> Reply | None:
        """What the robot answered last to this command in the running test; None if it has not yet.

        A copy, so that the program cannot change it; the object itself where that cannot be copied safely.
        """
        if _text_of(call.pattern) not in self._last_replies:
            return None
        last = self._last_replies[_text_of(call.pattern)]
        known = here(call)
        try:
            return Reply({}, restore(keep(last, known, self.handles), known))
        except NotKeptError:
            return Reply({}, last)


def here(call: Call) -> dict[str, Any]:
    """What a call knows before it is made, by name: the instance as ``self``, and the arguments."""
    invocation: Invocation = call.payload
    known = {} if invocation.instance is None else {"self": invocation.instance}
    given = invocation.arguments.values if invocation.arguments is not None else {}
    return {**given, **known}


def _text_of(pattern: Pattern | None) -> str | None:
    return pattern.text if pattern is not None else None


def _typed_like(value: Value, original: Value) -> Value:
    """``value`` in the type of the original, where that is a scalar of a numeric library."""
    if value is None:
        return None
    if hasattr(original, "dtype") and not hasattr(value, "dtype") and not getattr(original, "shape", None):
        kind = type(original)
        return kind(value) if getattr(original.dtype, "kind", "") == "f" else value
    return value
