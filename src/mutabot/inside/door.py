"""Between Python calls and the ``Call`` and ``Reply`` that operators see.

The door binds arguments to the vocabulary's quantities, writes changed values back into copies of the
arguments, performs the call, and does the same with the result. The user's own objects are never changed.
"""

from __future__ import annotations

import copy
import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from mutabot.errors import PathError
from mutabot.model import Call, Operation, Pattern, Quantity, Reply
from mutabot.model.notation import Notation
from mutabot.model.path import Path, Step
from mutabot.model.quantity import Value, is_reading_of
from mutabot.operators.driving import same

from .intercept import resolve


@dataclass(slots=True)
class Invocation:
    """A call as Python made it: the door's payload in ``Call.payload``.

    Attributes:
        wrapped: the original callable, bound.
        instance: the object it is bound to, or None.
        args, kwargs: as the program gave them.
        bound: the arguments by name, defaults applied; None if they do not fit the signature.
        message: the text command, or None.
    """

    wrapped: Callable[..., Any]
    instance: Any
    args: tuple[Any, ...]
    kwargs: dict[str, Any]
    bound: inspect.BoundArguments | None
    message: str | bytes | None = None


class Door:
    """Translates the calls of one operation.

    Args:
        operation: the operation.
        reading: the operation that ``operation.current`` names, or None.
        on_problem: told once about each path that does not fit: (key, error).

    Attributes:
        commands: how often the robot was made to do this, if it does anything.
    """

    def __init__(
        self,
        operation: Operation,
        reading: Operation | None,
        on_problem: Callable[[str, PathError], None] = lambda key, error: None,
    ) -> None:
        self.operation = operation
        self._reading = reading
        self._on_problem = on_problem
        self._signature: inspect.Signature | None = None
        self._paths: dict[str, Path] = {}
        self._last_replies: dict[str | None, Any] = {}
        self.commands = 0

    def reset(self) -> None:
        """Forget earlier answers and commands: a new test begins."""
        self._last_replies.clear()
        self.commands = 0

    def call(
        self, wrapped: Callable[..., Any], instance: Any, args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> Call:
        """The call as operators see it."""
        invocation = Invocation(wrapped, instance, args, kwargs, self._bind(wrapped, args, kwargs))
        pattern, values = self._written(invocation)

        async def current(quantity: Quantity) -> float:
            return await self._where(quantity, invocation)

        return Call(
            self.operation, pattern, values, current=current, idle=self._idle(pattern), payload=invocation
        )

    def perform(self, call: Call, original: Call) -> Any:
        """Do what the call says; returns the operation's own result (an awaitable for async ones)."""
        invocation: Invocation = call.payload
        fits = invocation.bound is not None or self._signature is None
        self.commands += self.operation.command and fits  # what does not fit never reaches the robot
        wrapped = self._opposite(invocation) if call.reversed and call.pattern is None else invocation.wrapped
        changed = {
            name: value for name, value in call.values.items() if not same(value, original.values.get(name))
        }
        if invocation.bound is None or (not changed and not call.reversed):
            return wrapped(*invocation.args, **invocation.kwargs)
        if call.pattern is not None:
            arguments = self._with_message(invocation, call, call.pattern)
        elif changed:
            arguments = self._with_values(invocation.bound, changed)
        else:
            return wrapped(*invocation.args, **invocation.kwargs)
        return wrapped(*arguments.args, **arguments.kwargs)

    def reply(self, call: Call, result: Any) -> Reply:
        """The reply as operators see it."""
        self._refuse_coroutine(result)
        values: dict[str, Value] = {}
        for quantity in call.pattern.result if call.pattern is not None else self.operation.result:
            try:
                value = quantity.path.get(result)
            except PathError as error:
                self._on_problem(f"result.{quantity.name}", error)
                continue
            if value is not None:
                values[quantity.name] = value
        self._last_replies[_text_of(call.pattern)] = result
        return Reply(values, result)

    def result(self, call: Call, reply: Reply, original: Reply | None) -> Any:
        """What the program receives: the result itself, or a copy with changed values."""
        result = reply.payload
        before: Mapping[str, Value] = original.values if original is not None else {}
        for quantity in call.pattern.result if call.pattern is not None else self.operation.result:
            if quantity.name in reply.values:
                value = reply.values[quantity.name]
                if not same(value, before.get(quantity.name)):
                    result = quantity.path.put(result, _typed_like(value, before.get(quantity.name)))
        return result

    def _refuse_coroutine(self, result: Any) -> None:
        """A plain function that hands out a coroutine has done nothing yet: it cannot be mutated in place."""
        if inspect.iscoroutine(result):
            text = f"{self.operation.target} returns a coroutine but is no coroutine function"
            error = PathError(
                f"{text}; name the coroutine function behind it", path="", step="call", found="coroutine"
            )
            self._on_problem("call", error)

    def _bind(
        self, wrapped: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> inspect.BoundArguments | None:
        try:
            if self._signature is None:
                self._signature = inspect.signature(wrapped)
            bound = self._signature.bind(*args, **kwargs)
        except (TypeError, ValueError):  # the call itself will say what is wrong; builtins have no signature
            return None
        bound.apply_defaults()
        return bound

    def _written(self, invocation: Invocation) -> tuple[Pattern | None, dict[str, Value]]:
        if invocation.bound is None:
            return None, {}
        if self.operation.message is not None:
            return self._read_message(invocation, invocation.bound)
        values = {}
        for quantity in self.operation.arguments:
            try:
                value = self._path(quantity).get(self._start(quantity, invocation.bound))
            except PathError as error:
                self._on_problem(f"arguments.{quantity.name}", error)
                continue
            if value is not None:
                values[quantity.name] = value
        return None, values

    def _read_message(
        self, invocation: Invocation, bound: inspect.BoundArguments
    ) -> tuple[Pattern | None, dict[str, Value]]:
        message = bound.arguments.get(self.operation.message or "")
        if not isinstance(message, str | bytes):
            return None, {}
        invocation.message = message
        text = _body(message)[0]
        for pattern in self.operation.patterns:
            values = Notation.compile(pattern.text).read(text)
            if values is not None:
                named = {quantity.name for quantity in pattern.arguments}
                return pattern, {name: value for name, value in values.items() if name in named}
        return None, {}

    def _with_message(self, invocation: Invocation, call: Call, pattern: Pattern) -> inspect.BoundArguments:
        bound, message = invocation.bound, invocation.message
        assert bound is not None
        assert message is not None
        text, ending = _body(message)
        notation = Notation.compile(pattern.text)
        values = {**(notation.read(text) or {}), **call.values}
        if call.reversed and pattern.opposite is not None:
            written = Notation.compile(pattern.opposite).write(values, looks=notation.looks(text)) + ending
        else:
            written = notation.write(values, like=text) + ending
        changed = copy.copy(bound)
        changed.arguments = dict(bound.arguments)
        name = self.operation.message or ""
        changed.arguments[name] = written.encode() if isinstance(message, bytes) else written
        return changed

    def _with_values(
        self, bound: inspect.BoundArguments, values: Mapping[str, Value]
    ) -> inspect.BoundArguments:
        changed = copy.copy(bound)
        changed.arguments = dict(bound.arguments)
        for quantity in self.operation.arguments:
            if quantity.name in values:
                root = self._path(quantity).root or ""
                changed.arguments[root] = self._path(quantity).put(
                    changed.arguments[root], values[quantity.name]
                )
        return changed

    def _path(self, quantity: Quantity) -> Path:
        """The quantity's path; an argument that goes through ``**kwargs`` is a key of that."""
        path = self._paths.get(quantity.name)
        if path is None:
            path = quantity.path
            parameters = self._signature.parameters if self._signature is not None else {}
            if path.root not in parameters:
                for parameter in parameters.values():
                    if parameter.kind is inspect.Parameter.VAR_KEYWORD:
                        path = Path(parameter.name, (Step(item=path.root), *path.steps))
            self._paths[quantity.name] = path
        return path

    def _start(self, quantity: Quantity, bound: inspect.BoundArguments) -> Any:
        path = self._path(quantity)
        first = path.steps[0] if path.steps else None
        start = bound.arguments.get(path.root or "")
        if path is not quantity.path and first is not None and first.item not in (start or {}):
            return {first.item: None}  # this call does not give it
        return start

    def _opposite(self, invocation: Invocation) -> Callable[..., Any]:
        assert self.operation.opposite is not None
        opposite: Callable[..., Any] = self._other(self.operation.opposite, invocation.instance)
        return opposite

    def _other(self, target: str, instance: Any) -> Any:
        """Another attribute of the same object, or of its module where that is not possible."""
        module, _, qualname = target.partition(":")
        name = qualname.rpartition(".")[2]
        if instance is not None and "." in qualname and hasattr(type(instance), name):
            return getattr(instance, name)
        owner, name, _ = resolve(sys.modules[module], qualname)
        return getattr(owner, name)

    async def _where(self, quantity: Quantity, invocation: Invocation) -> float:
        reading = self._reading
        if reading is None:
            raise LookupError(f"{self.operation.target} names no reading that tells where {quantity.name} is")
        value = self._other(reading.target, invocation.instance)
        if callable(value):
            value = value()
        if inspect.isawaitable(value):
            value = await value
        for part in reading.result:
            if is_reading_of(part, quantity):
                number = part.path.get(value)
                return quantity.from_unit(float(number), part.unit) if part.unit else float(number)
        raise LookupError(f"{reading.target} does not read the {quantity.axis} of a {quantity.kind}")

    def _idle(self, pattern: Pattern | None) -> Reply | None:
        """What this command would answer if the robot did nothing: what it answered last."""
        if _text_of(pattern) not in self._last_replies:
            return None
        last = self._last_replies[_text_of(pattern)]
        try:
            return Reply({}, copy.copy(last))
        except Exception:  # a result that cannot be copied: better the object itself than a broken program
            return Reply({}, last)


def _text_of(pattern: Pattern | None) -> str | None:
    return pattern.text if pattern is not None else None


def _body(message: str | bytes) -> tuple[str, str]:
    """A message without its line ending, and the ending."""
    text = message.decode("utf-8", "surrogateescape") if isinstance(message, bytes) else message
    body = text.rstrip("\r\n")
    return body, text[len(body) :]


def _typed_like(value: Value, original: Value) -> Value:
    """``value`` in the type of the original, where that is a scalar of a numeric library."""
    if hasattr(original, "dtype") and not hasattr(value, "dtype") and not getattr(original, "shape", None):
        kind = type(original)
        return kind(value) if getattr(original.dtype, "kind", "") == "f" else value
    return value
