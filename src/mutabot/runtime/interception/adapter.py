"""Between Python calls and the ``Call`` and ``Reply`` that operators see.

The door binds arguments to the vocabulary's quantities, writes changed values back into copies of the
arguments, performs the call, and does the same with the result. The user's own objects are never changed.

What a call writes: which command it is, the values it gives, and the same call with other values.

What commands answer: noted in the baseline, and given while the robot does nothing.

The robot is called by the program: what looks at its caller finds the program's line.

Warnings with ``stacklevel=2``, ``sys._getframe(1)`` and ``inspect.stack()[1]`` tell by whom a function was
called. Between the program and an operation there are frames of ours; the last of them has the program's
file, line, function and global names.
"""

from __future__ import annotations

import copy
import inspect
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from types import CodeType, FrameType, FunctionType
from typing import Any

from mutabot.errors import PathError
from mutabot.model import Call, NotToldError, Operation, Pattern, Quantity, Reply, Vocabulary
from mutabot.model.answer import NotKeptError, is_member, is_of_numpy, is_plain, keep, name_of, restore
from mutabot.model.notation import Notation
from mutabot.model.operation import Form
from mutabot.model.path import Path
from mutabot.model.quantity import Value, changes, is_reading_of, is_same
from mutabot.runtime.interception.arguments import Arguments, signature_for
from mutabot.runtime.interception.mishaps import why_not
from mutabot.runtime.observation.clock import ProgramTime
from mutabot.runtime.targets.target import Means, resolve


@dataclass(frozen=True, slots=True)
class Message:
    """The argument that says which command it is.

    Attributes:
        value: the argument itself.
        text: its text, without a line ending.
        ending: the line ending.
    """

    value: Any
    text: str
    ending: str = ""

    @classmethod
    def of(cls, value: Any) -> Message | None:
        """The message in an argument: text, bytes, or anything else by what it prints."""
        if value is None:
            return None
        if isinstance(value, str | bytes):
            text = value.decode("utf-8", "surrogateescape") if isinstance(value, bytes) else value
            body = text.rstrip("\r\n")
            return cls(value, body, text[len(body) :])
        try:
            return cls(value, str(value))
        except Exception:  # an object of the user's may fail to print itself in any way
            return None

    @property
    def can_be_written(self) -> bool:
        """Whether another text can be put in its place."""
        return isinstance(self.value, str | bytes | int) and not isinstance(self.value, bool)

    def with_text(self, text: str) -> Any:
        """The argument with another text."""
        if isinstance(self.value, int):
            return int(text)
        text += self.ending
        return text.encode("utf-8", "surrogateescape") if isinstance(self.value, bytes) else text


class Writer:
    """Reads and changes what the calls of one operation write.

    Args:
        operation: the operation.
        on_problem: told about each path or argument that does not fit: (key, error).
    """

    def __init__(self, operation: Operation, on_problem: Callable[[str, PathError], None]) -> None:
        self._operation = operation
        self._on_problem = on_problem
        self._path = Path.parse(operation.message, rooted=True) if operation.message is not None else None
        self._parts = {pattern.text: _parts(pattern) for pattern in operation.patterns}

    def message(self, arguments: Arguments, instance: Any) -> Message | None:
        """What says which command a call is; None if the operation has no such argument, or the call."""
        if self._path is None:
            return None
        if self._path.root == "self" and instance is None:
            self._tell("message", f"{self._operation.target} is called on no object, so it has no self")
        start = instance if self._path.root == "self" else arguments.get(self._path.root or "")
        try:
            return Message.of(self._path.get(start)) if start is not None else None
        except PathError as error:
            self._on_problem("message", error)
            return None

    def read(
        self, arguments: Arguments, instance: Any, message: Message | None
    ) -> tuple[Pattern | None, dict[str, Value]]:
        """Which of the operation's commands a call is, if any, and the values it writes."""
        undecided = []
        for pattern, values in self._candidates(message):
            unfit = [
                case for case in pattern.when if case.value not in _names(arguments, instance, case.argument)
            ]
            if not unfit:
                return pattern, self._written(pattern, values, arguments, message)
            if all(case.key == "mode" for case in unfit):
                undecided.append(pattern)
        if undecided:
            self._tell_undecided(undecided, arguments)
        return None, self._values(self._operation.arguments, arguments)

    def changed(
        self, call: Call, values: Mapping[str, Value], arguments: Arguments, message: Message | None
    ) -> tuple[tuple[Any, ...], dict[str, Any]]:
        """Positional and keyword arguments of a call with these other values, or of its opposite."""
        pattern = call.pattern
        fields, beside = self._parts[pattern.text] if pattern is not None else ((), self._operation.arguments)
        roots: dict[str, Any] = {}
        for quantity in beside:
            if quantity.name in values:
                root = quantity.path.root or ""
                roots[root] = quantity.put(roots.get(root, arguments.get(root)), values[quantity.name])
        is_said_otherwise = call.reversed or any(name in values for name in fields)
        if pattern is not None and message is not None and self._path is not None and is_said_otherwise:
            _put(roots, arguments, self._path, message.with_text(_text(pattern, call, message)))
        return arguments.replaced(roots)

    def _candidates(self, message: Message | None) -> Iterator[tuple[Pattern, dict[str, Value]]]:
        for pattern in self._operation.patterns:
            if pattern.notation is None:
                yield pattern, {}
                continue
            values = Notation.compile(pattern.notation).read(message.text) if message is not None else None
            if values is not None:
                yield pattern, values

    def _written(
        self, pattern: Pattern, said: Mapping[str, Value], arguments: Arguments, message: Message | None
    ) -> dict[str, Value]:
        fields, beside = self._parts[pattern.text]
        found = self._values(beside, arguments) if beside else {}
        if fields and message is not None and self._can_be_written(message):
            found |= {name: said[name] for name in fields}
        elif pattern.notation is not None and pattern.opposite is not None and message is not None:
            self._can_be_written(message)
        return found

    def _can_be_written(self, message: Message) -> bool:
        """Whether the text can be changed; a problem if not."""
        if not message.can_be_written:
            kind = type(message.value).__name__
            text = f"{self._operation.message} is {_a(kind)}, whose text cannot be changed"
            self._tell("message", f"{text}; describe the arguments beside it, and no opposite")
        return message.can_be_written

    def _values(self, quantities: tuple[Quantity, ...], arguments: Arguments) -> dict[str, Value]:
        values = {}
        for quantity in quantities:
            start = arguments.get(quantity.path.root or "")
            try:
                value = quantity.get(start) if start is not None else None
            except PathError as error:
                self._on_problem(f"arguments.{quantity.name}", error)
                continue
            if value is not None:
                values[quantity.name] = value
        return values

    def _tell_undecided(self, patterns: list[Pattern], arguments: Arguments) -> None:
        """No mode fits: say which argument has a value that the vocabulary does not mention."""
        cases = [case for pattern in patterns for case in pattern.when if case.key == "mode"]
        for argument in dict.fromkeys(case.argument for case in cases):
            known = tuple(dict.fromkeys(case.value for case in cases if case.argument == argument))
            found = _names(arguments, None, argument)
            if not set(found) & set(known):
                text = f"{argument} is {found[-1]}, for which mode says nothing; it knows {', '.join(known)}"
                self._tell("mode", text)

    def _tell(self, key: str, text: str) -> None:
        self._on_problem(key, PathError(text, path="", step="", found=""))


def _parts(pattern: Pattern) -> tuple[tuple[str, ...], tuple[Quantity, ...]]:
    """The names of the described fields of a command's text, and the quantities beside it."""
    fields = pattern.fields
    named = tuple(quantity.name for quantity in pattern.arguments if quantity.name in fields)
    return named, tuple(quantity for quantity in pattern.arguments if quantity.name not in fields)


def _put(roots: dict[str, Any], arguments: Arguments, path: Path, value: Any) -> None:
    root = path.root or ""
    roots[root] = path.put(roots.get(root, arguments.get(root)), value)


def _text(pattern: Pattern, call: Call, message: Message) -> str:
    """The text of the command with the call's values, or that of its opposite."""
    notation = Notation.compile(pattern.notation or "")
    values = {**(notation.read(message.text) or {}), **call.values}
    if call.reversed and pattern.opposite is not None:
        return Notation.compile(pattern.opposite).write(values, looks=notation.looks(message.text))
    return notation.write(values, like=message.text)


def _names(arguments: Arguments, instance: Any, argument: str) -> tuple[str, ...]:
    """What a vocabulary may call the value of an argument that decides what the call means."""
    path = Path.parse(argument, rooted=True)
    start = instance if path.root == "self" else arguments.get(path.root or "")
    try:
        value = path.get(start) if start is not None else None
    except PathError:
        value = None
    if value is None:
        return ("none",)
    if is_member(value):
        return (str(value.value), name_of(value))
    try:
        if isinstance(value, bytes):
            return (str(value), value.decode("utf-8", "surrogateescape"))
        whole = (str(int(value)),) if isinstance(value, float) and value.is_integer() else ()
        is_truth = type(value).__name__ in ("bool", "bool_") or value in (0, 1)
        return (*((str(bool(value)).lower(),) if is_truth else ()), *whole, str(value))
    except Exception:  # as above: any object of the user's
        return (f"a {type(value).__name__}",)


def _a(name: str) -> str:
    return f"{'an' if name[:1].lower() in 'aeiou' else 'a'} {name}"


#: containers that a program may change after it got them
_CHANGEABLE = frozenset({list, dict, set, bytearray})


#: stands for an answer that cannot be kept and that the program waits for: it never comes
LOST = {"pending": ""}


@dataclass(frozen=True, slots=True)
class Returned:
    """What a call returned, and what it knew: the instance as ``self``, and the arguments.

    ``can_be_lost`` is whether the middleware knows what a program meets whose answer never comes.
    """

    value: Any
    here: Mapping[str, Any]
    can_be_lost: bool = False


@dataclass(slots=True)
class Answers:
    """The answers of the running test, for the trace.

    Plain values are noted as they are. Of others, the first at each site is noted by value, and later ones
    only by whether they are the same: what the robot answered first is all that is needed.

    Attributes:
        handles: classes that are part of the robot API.
    """

    handles: Collection[str] = ()
    _first: dict[int, Any] = field(default_factory=dict)
    _varying: set[int] = field(default_factory=set)

    @classmethod
    def of(cls, vocabulary: Vocabulary) -> Answers:
        """For this robot API."""
        return cls(handles_of(vocabulary))

    def start(self) -> None:
        """A new test begins."""
        self._first.clear()
        self._varying.clear()

    def note(self, site: int, returned: Returned | None) -> Any:
        """The note about an answer at a site; None for ``returned`` if the call raised."""
        if returned is None:
            return {"raised": True}
        if is_plain(returned.value):
            self._first.setdefault(site, returned.value)
            return returned.value
        if site in self._varying:
            return {"other": True}
        data = self._data(returned)
        if site not in self._first:
            self._first[site] = data
            return data
        if data == self._first[site] and "kept" in data:
            return {"same": True}
        self._varying.add(site)
        return {"other": True}

    def _data(self, returned: Returned) -> dict[str, Any]:
        try:
            return {"kept": keep(returned.value, returned.here, self.handles)}
        except NotKeptError as error:
            return {"kept": LOST} if returned.can_be_lost else {"opaque": str(error)}
        except Exception as error:  # objects of the user's may do anything when they are looked at
            return {"opaque": f"{type(returned.value).__qualname__}, which raises {error!r}"}


def handles_of(vocabulary: Vocabulary) -> frozenset[str]:
    """The classes that have operations as methods."""
    owners = (operation.target.rpartition(".")[0] for operation in vocabulary.operations)
    return frozenset(owner for owner in owners if ":" in owner)


def snapshot(value: Any) -> Any:
    """An answer as it is now: a program may change the list or array it got."""
    if type(value) in _CHANGEABLE or is_of_numpy(value):
        return copy.copy(value)
    return tuple(map(snapshot, value)) if type(value) is tuple else value


Caller = Callable[[Callable[..., Any], tuple[Any, ...], dict[str, Any]], Any]


def _call(wrapped: Any, args: Any, kwargs: Any, __tracebackhide__: bool = True) -> Any:
    return wrapped(*args, **kwargs)


async def _async_call(wrapped: Any, args: Any, kwargs: Any, __tracebackhide__: bool = True) -> Any:
    return await wrapped(*args, **kwargs)


#: code units of one entry of a table of places, and its kind: all of a span is told
_MOST_UNITS, _LONG = 8, 14


class Callers:
    """Makes calls in the name of frames."""

    def __init__(self) -> None:
        # the code is kept, so that no other can get its address
        self._made: dict[tuple[int, int, bool], tuple[Caller, CodeType, dict[str, Any]]] = {}

    def of(self, frame: FrameType, is_async: bool) -> Caller:
        """What makes a call as if this frame did, where it stands now."""
        code = frame.f_code
        key = (id(code), frame.f_lasti, is_async)
        known = self._made.get(key)
        if known is None or known[2] is not frame.f_globals:
            made = _made(code, frame.f_lasti, frame.f_globals, is_async)
            known = self._made[key] = (made, code, frame.f_globals)
        return known[0]


def _made(code: CodeType, instruction: int, names: dict[str, Any], is_async: bool) -> Caller:
    line, end_line, column, end_column = list(code.co_positions())[instruction // 2]
    line = line or code.co_firstlineno
    own = (_async_call if is_async else _call).__code__
    own = own.replace(
        co_name=code.co_name,
        co_qualname=code.co_qualname,
        co_filename=code.co_filename,
        co_firstlineno=line,
        co_linetable=_all_at(len(own.co_code) // 2, (end_line or line) - line, column or 0, end_column or 0),
    )
    return FunctionType(own, names, code.co_name, (True,))


def _all_at(units: int, lines: int, column: int, end_column: int) -> bytes:
    """A table that gives the span to all of a code: from its first line on, so many more lines.

    The format: CPython, Objects/locations.md (3.11 to 3.13). Compiling a tree with places takes ten times as
    long, and every fork calls from places where nothing has called before.
    """
    found = bytearray()
    for first in range(0, units, _MOST_UNITS):
        size = min(_MOST_UNITS, units - first)
        found.append(1 << 7 | _LONG << 3 | size - 1)
        for number in (0, lines, column + 1, end_column + 1):
            found += _varint(number)
    return bytes(found)


def _varint(number: int) -> bytes:
    """Six bits a byte, the lowest first; a seventh says that more follow."""
    if number < 1 << 6:
        return bytes([number])
    return bytes([1 << 6 | number & 0x3F]) + _varint(number >> 6)


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
