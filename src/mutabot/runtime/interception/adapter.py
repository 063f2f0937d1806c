"""Translate between Python calls and the ``Call`` and ``Reply`` that operators see.

The adapter binds arguments to the vocabulary's quantities, writes changed values back into copies of the
arguments, performs the call, and does the same with the result. It never changes the user's own objects.

A changed argument goes to the callable in the way the program gave it: by position or by keyword. What the
program left out stays left out, so that a native callable sees only what it was given.
"""

from __future__ import annotations

import copy
import inspect
import sys
import weakref
from collections.abc import Awaitable, Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from inspect import Parameter, Signature
from types import CoroutineType
from typing import Any, Protocol

from mutabot.errors import PathError, StrangeValueError, error_text, nearest_name
from mutabot.model import Call, Operation, Path, Pattern, Quantity, Reply, Unchanged, Vocabulary
from mutabot.model.answer import keep, restore
from mutabot.model.data import UNKNOWN, is_mock, is_of_numpy, is_textual
from mutabot.model.enumeration import is_member, name_of
from mutabot.model.notation import Notation
from mutabot.model.operation import Form
from mutabot.model.path import class_name
from mutabot.model.quantity import Value, is_reading_of
from mutabot.model.signature import ANYTHING, parse_signature, signature_of
from mutabot.runtime.interception.call_faults import why_not
from mutabot.runtime.interception.live import copied
from mutabot.runtime.targets.target import NOWHERE, CallPlace, Handler, Where, resolve
from mutabot.runtime.targets.wrapper import WRAPPERS, Method, unbound

#: containers that a program may change after it got them
_CHANGEABLE = frozenset({list, dict, set, bytearray})
_POSITIONAL = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)
#: makes a call of a callable as the program does
Caller = Callable[[Callable[..., Any], tuple[Any, ...], dict[str, Any]], Any]


def _apply(wrapped: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    return wrapped(*args, **kwargs)


@dataclass(slots=True)
class Invocation:
    """A call as Python made it: ``Call.payload``.

    Attributes:
        wrapped: the original callable, bound.
        instance: the object it is bound to, or None.
        args, kwargs: as the program gave them.
        where: what the frames do not show of it.
        caller: makes calls of callables as the program does.
        signature: by which the arguments are read.
        values: the arguments by parameter, with known defaults; None if they do not fit the signature.
        message: the argument that says which command it is, or None.
        text: its text, without a line ending; None if it has none.
    """

    wrapped: Callable[..., Any] = field(compare=False)
    instance: Any
    args: tuple[Any, ...]
    kwargs: dict[str, Any]
    where: Where = field(default=NOWHERE, compare=False)
    caller: Caller = field(default=_apply, compare=False)
    signature: Signature = field(default=ANYTHING, compare=False)
    values: dict[str, Any] | None = field(default=None, compare=False)
    message: Any = field(default=None, compare=False)
    text: str | None = field(default=None, compare=False)

    def bind(self, signature: Signature) -> None:
        """Bind the arguments to a signature. If they do not fit, the call itself will raise."""
        self.signature = signature
        try:
            bound = signature.bind(*self.args, **self.kwargs)
        except TypeError:
            self.values = None
            return
        bound.apply_defaults()
        self.values = {name: value for name, value in bound.arguments.items() if value is not ...}

    def get(self, name: str) -> Any:
        """Return the argument of this name, which may be one of ``**kwargs``; None if the call gives none."""
        values = self.values or {}
        if name in self.signature.parameters:
            return values.get(name)
        for parameter in self.signature.parameters.values():
            if parameter.kind is Parameter.VAR_KEYWORD:
                return values.get(parameter.name, {}).get(name)
        return None

    def start_of(self, path: Path) -> Any:
        """Return the object at which a path begins: an argument, or the instance as ``self``."""
        return self.instance if path.root == "self" else self.get(path.root or "")

    def changed(self, arguments: Mapping[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
        """Return positional and keyword arguments with other values for these names."""
        args, kwargs = list(self.args), dict(self.kwargs)
        for name, value in arguments.items():
            self._change(args, kwargs, name, value)
        return tuple(args), kwargs

    def _change(self, args: list[Any], kwargs: dict[str, Any], name: str, value: Any) -> None:
        parameter = self.signature.parameters.get(name)
        kind = parameter.kind if parameter is not None else Parameter.KEYWORD_ONLY
        positional = [
            parameter.name
            for parameter in self.signature.parameters.values()
            if parameter.kind in _POSITIONAL
        ]
        values = self.values or {}
        if kind is Parameter.VAR_POSITIONAL:
            args[len(positional) :] = value
        elif kind is Parameter.VAR_KEYWORD:
            for key in values.get(name, ()):
                kwargs.pop(key, None)
            kwargs.update(value)
        elif kind in _POSITIONAL and positional.index(name) < len(args):
            args[positional.index(name)] = value
        elif kind is Parameter.POSITIONAL_ONLY:  # a default: what comes before it must be given as well
            before = positional[len(args) : positional.index(name)]
            args.extend(values.get(name) for name in before)
            args.append(value)
        else:
            kwargs[name] = value

    def copied(self, names: Collection[str] | None = None) -> Invocation:
        """Return the same call with copies of all arguments, or of those with these names.

        The program may use an object again for its next call.
        """
        if self.values is None or names is None:
            args, kwargs, values = copied((self.args, self.kwargs, self.values))
            return replace(self, args=args, kwargs=kwargs, values=values)
        known = self.values
        args, kwargs = self.changed({name: copied(known[name]) for name in names if name in known})
        found = replace(self, args=args, kwargs=kwargs)
        found.bind(self.signature)
        return found


@dataclass(slots=True)
class SiteCall:
    """A call of an operation at a site, in the running test.

    Attributes:
        site: where it stands.
        call: the call.
        number: of the call among those of its site in this test, from 1.
        is_async: whether what the operation returns is to be awaited.
        is_direct: whether the program itself makes the call, rather than a library that it calls.
        stands_in: whether something else than the robot gets the call, in the baseline.
    """

    site: CallPlace
    call: Call
    number: int
    is_async: bool = False
    is_direct: bool = False
    stands_in: bool = False


class CallCheck(Protocol):
    """The interface of a check before each call of an operation."""

    def check(self, invocation: Invocation) -> None:
        """Raise if the call must not be made."""

    def check_opposite(self, target: str) -> None:
        """Raise if the opposite of the operation must not be called."""


@dataclass(eq=False)
class Adapter:
    """Translates the calls of one operation.

    Attributes:
        operation: the operation.
        readings: the operations that read where the robot is, by name.
        on_problem: called with (key, error) for each path or argument that does not fit.
        lately: values that last came by under the names of a middleware, by target; adapters share it.
        handles: classes that are part of the robot API: their objects are never copied.
        now, wait: return the program's time, s, and let a number of seconds of it pass.
        handler: what stands around the operation.
        remembers: the commands, by the texts of their patterns, whose last answers may be asked for.
        commands: how often the robot was made to do this, if it does anything.
        asks: how often a mutant asked the robot where it is.
        guard: what is asked before each call; None without guards.
    """

    operation: Operation
    readings: Mapping[str, Operation | None]
    on_problem: Callable[[str, PathError], None]
    lately: dict[str, Mapping[str, Value]]
    handles: Collection[str]
    now: Callable[[], float]
    wait: Callable[[float], Awaitable[None]]
    handler: Handler = field(init=False)
    remembers: Collection[str | None] = ()
    commands: int = 0
    asks: int = 0
    guard: CallCheck | None = None

    def __post_init__(self) -> None:
        operation = self.operation
        self._message = Path.parse(operation.message, rooted=True) if operation.message is not None else None
        self._declared = parse_signature(operation.signature) if operation.signature is not None else None
        self._parts = {pattern.text: _parts(pattern) for pattern in operation.patterns}
        self._own: Signature | None = None
        self._fixed_parts: dict[tuple[str, type[Any]], str] = {}
        self._last_answers: dict[str | None, Callable[[Mapping[str, Any]], Any]] = {}
        self._last_written: dict[str | None, dict[str, Value]] = {}

    def reset(self) -> None:
        """Begin a test: forget earlier answers and commands."""
        self._last_answers.clear()
        self._last_written.clear()
        self.lately.clear()
        self.commands = self.asks = 0

    def to_call(self, invocation: Invocation) -> Call:
        """Return the call as operators see it."""
        signature = self._declared or invocation.where.signature or self._own
        if signature is None:
            signature = self._own = signature_of(invocation.wrapped) or ANYTHING
        invocation.bind(signature)
        pattern, values = None, dict[str, Value]()
        if invocation.values is not None:
            if self._message is not None:
                self._read_message(invocation, self._message)
            pattern, values = self._read_command(invocation)
        key = pattern.text if pattern is not None else None
        before = self._last_written.get(key)
        self._last_written[key] = {name: snapshot(value) for name, value in values.items()}
        means = invocation.where.means
        return Call(
            self.operation, pattern, values, current=partial(self._where_is, invocation, pattern),
            payload=invocation, cannot=partial(why_not, means), previous=lambda: before,
            time=self.now, wait=self.wait if means is None else means.sleep,
        )  # fmt: skip

    def _read_message(self, invocation: Invocation, path: Path) -> None:
        """Read the text, bytes or printed object that identifies the command of a call."""
        if path.root == "self" and invocation.instance is None:
            self._report_problem(
                "message", f"{self.operation.target} is called on no object, so it has no self"
            )
        start = invocation.start_of(path)
        try:
            invocation.message = path.get(start) if start is not None else None
        except PathError as error:
            self._does_not_fit("message", error, invocation.where)
            return
        if invocation.message is not None:
            invocation.text = _text(invocation.message)

    def _read_command(self, invocation: Invocation) -> tuple[Pattern | None, dict[str, Value]]:
        """Return the command of a call, if it has one, and the values that it writes."""
        undecided = []
        for pattern in self.operation.patterns:
            values: Mapping[str, Value] | None = {}
            if pattern.notation is not None:
                text = invocation.text
                values = Notation.compile(pattern.notation).read(text) if text is not None else None
            if values is None:
                continue
            unfit = [case for case in pattern.when if case.value not in _names(invocation, case.argument)]
            if not unfit:
                return pattern, self._written(pattern, values, invocation)
            if all(case.key == "mode" for case in unfit):
                undecided.append(pattern)
        if undecided:
            self._report_undecided(undecided, invocation)
        return None, self._values(self.operation.arguments, invocation)

    def _written(
        self, pattern: Pattern, values: Mapping[str, Value], invocation: Invocation
    ) -> dict[str, Value]:
        fields, beside = self._parts[pattern.text]
        found = self._values(beside, invocation)
        needs_text = bool(fields) or (pattern.notation is not None and pattern.opposite is not None)
        if needs_text and invocation.text is not None and self._can_be_written(invocation.message):
            found |= {name: values[name] for name in fields}
        return found

    def _can_be_written(self, message: Any) -> bool:
        """Return whether the text can be changed; report a problem if it cannot."""
        if isinstance(message, str | bytes | int) and not isinstance(message, bool):
            return True
        kind = type(message).__name__
        which = f"{'an' if kind[:1].lower() in 'aeiou' else 'a'} {kind}"
        text = f"{self.operation.message} is {which}, whose text cannot be changed"
        self._report_problem("message", f"{text}; describe the arguments beside it, and no opposite")
        return False

    def _values(self, quantities: tuple[Quantity, ...], invocation: Invocation) -> dict[str, Value]:
        starts = [(quantity, invocation.get(quantity.path.root or "")) for quantity in quantities]
        return self._read([pair for pair in starts if pair[1] is not None], "arguments", invocation.where)

    def _read_result(
        self, quantities: tuple[Quantity, ...], result: Any, where: Where = NOWHERE
    ) -> dict[str, Value]:
        return self._read([(quantity, result) for quantity in quantities], "result", where)

    def _read(self, quantities: list[tuple[Quantity, Any]], key: str, where: Where) -> dict[str, Value]:
        """Read quantities, each from the object at which its path begins."""
        values: dict[str, Value] = {}
        for quantity, start in quantities:
            try:
                found = quantity.path.get(start)
                if is_mock(found):
                    continue  # it is no value, and to look at it would be to call it
                value = quantity.of(found)
            except Exception as error:  # objects of the user's may do anything when they are looked at
                self._does_not_fit(f"{key}.{quantity.name}", _unread(quantity, error), where)
                continue
            if value is UNKNOWN:
                self.on_problem(f"{key}.{quantity.name}", _strange_value_error(quantity, found))
            elif quantity.path.steps and (fixed := self._fixed_part(quantity, start)):
                text = f"{fixed} cannot be replaced, so the value is left as it is"
                self.on_problem(f"{key}.{quantity.name}", StrangeValueError(text))
            elif value is not None:
                values[quantity.name] = value
        return values

    def _fixed_part(self, quantity: Quantity, start: Any) -> str:
        """Return what on a quantity's path cannot be replaced, as in the first object of this class."""
        seen = quantity.name, type(start)
        if seen not in self._fixed_parts:
            self._fixed_parts[seen] = quantity.path.fixed_part(start)
        return self._fixed_parts[seen]

    def _report_undecided(self, patterns: list[Pattern], invocation: Invocation) -> None:
        """Report the argument whose value fits no mode of the vocabulary."""
        cases = [case for pattern in patterns for case in pattern.when if case.key == "mode"]
        for argument in dict.fromkeys(case.argument for case in cases):
            known = tuple(dict.fromkeys(case.value for case in cases if case.argument == argument))
            found = _names(invocation, argument)
            if not set(found) & set(known):
                text = f"{argument} is {found[-1]}, which `mode` does not list; it lists {', '.join(known)}"
                self._does_not_fit("mode", PathError(text), invocation.where)

    def _does_not_fit(self, key: str, error: PathError, where: Where) -> None:
        """Report what the vocabulary does not describe; a mock or a fake may be given anything.

        Not so a step that looks misspelt: another one of the value is nearly called so.
        """
        if where.stands_in and nearest_name(error.step or "", error.known) is None:
            error = StrangeValueError(f"{error}; a mock or a fake got it, so it is left as it is")
        self.on_problem(key, error)

    def _report_problem(self, key: str, text: str) -> None:
        self.on_problem(key, PathError(text))

    def perform(self, call: Call, changed: Mapping[str, Value] | None) -> Any:
        """Carry out a call and return the operation's own result (an awaitable for async ones).

        ``changed``: its values that are not those of the program's call; None if it is that call.
        """
        invocation: Invocation = call.payload
        fits = invocation.values is not None or self.operation.signature is not None
        self.commands += call.is_command and fits  # what does not fit never reaches the robot
        if changed is None:
            if self.guard is not None:
                self.guard.check(invocation)
            return invocation.caller(invocation.wrapped, invocation.args, invocation.kwargs)
        is_text = call.pattern is not None and call.pattern.notation is not None
        meant = call.pattern if call.pattern is not None else call.operation
        opposite = meant.opposite if call.reversed and not is_text else None
        wrapped = self._other(opposite, invocation) if opposite is not None else invocation.wrapped
        args, kwargs = invocation.args, invocation.kwargs
        if invocation.values is not None and (changed or call.reversed):
            args, kwargs = invocation.changed(self._changed(call, changed))
        if self.guard is not None:
            if opposite is not None:
                self.guard.check_opposite(opposite)
            else:
                self.guard.check(replace(invocation, args=args, kwargs=kwargs))
        return invocation.caller(wrapped, args, kwargs)

    def _changed(self, call: Call, values: Mapping[str, Value]) -> dict[str, Any]:
        """Return the changed arguments of a call with these values, or of its opposite."""
        invocation, pattern = call.payload, call.pattern
        fields, beside = self._parts[pattern.text] if pattern is not None else ((), self.operation.arguments)
        changed: dict[str, Any] = {}
        for quantity in beside:
            if quantity.name in values:
                root = quantity.path.root or ""
                changed[root] = quantity.put(changed.get(root, invocation.get(root)), values[quantity.name])
        is_said_otherwise = call.reversed or any(name in values for name in fields)
        path = self._message
        if pattern is not None and path is not None and invocation.text is not None and is_said_otherwise:
            root = path.root or ""
            message = _with_text(invocation.message, _changed_text(pattern, call, invocation.text))
            changed[root] = path.put(changed.get(root, invocation.get(root)), message)
        return changed

    def to_reply(self, call: Call, result: Any) -> Reply:
        """Return the reply as operators see it."""
        self._check_result(call.payload, result)
        meant = call.pattern if call.pattern is not None else self.operation
        values = self._read_result(meant.result, result, call.payload.where)
        if self.remembers and call.is_command:
            self._remember(call, result)
        if self.operation.named is not None:
            self.lately[self.operation.target] = {**call.values, **values}
        return Reply(values, result)

    def observe_message(self, name: str, message: Any) -> None:
        """Note a message that the program may receive without calling this operation."""
        named = self.operation.named
        if named is not None and named.node is None and named.fits(Form.RECEIVE, name, None):
            self.lately[self.operation.target] = self._read_result(self.operation.result, message)

    def to_result(self, call: Call, reply: Reply, original: Reply | None) -> Any:
        """Return the program's result: the result itself, or a copy with changed values."""
        result = reply.payload
        before: Mapping[str, Value] = original.values if original is not None else {}
        for quantity in call.pattern.result if call.pattern is not None else self.operation.result:
            if quantity.name in reply.values:
                value = reply.values[quantity.name]
                if not quantity.is_same(value, before.get(quantity.name)):
                    result = quantity.put(result, value)
        return result

    def _check_result(self, invocation: Invocation, result: Any) -> None:
        """Report a coroutine that is not awaited, and a successful call that contradicts its signature."""
        if type(result) is CoroutineType:
            text = f"{self.operation.target} returns a coroutine but is not a coroutine function"
            self._report_problem("call", f"{text}; name the coroutine function behind it")
        if invocation.values is None and self.operation.signature is not None:
            given = [*("…" for _ in invocation.args), *(f"{name}=…" for name in invocation.kwargs)]
            text = f"{self.operation.signature} does not take the call ({', '.join(given)})"
            self._report_problem("signature", text)

    def _other(self, target: str, invocation: Invocation) -> Any:
        """Return another attribute of the same object, or of its module if that is not possible."""
        module, _, qualname = target.partition(":")
        name = qualname.rpartition(".")[2]
        instance, receiver = invocation.instance, invocation.where.receiver
        if instance is not None and "." in qualname and hasattr(type(instance), name):
            return getattr(instance, name)
        found = getattr(receiver, name, None)  # of a mock, or of what stands in for a module
        if receiver is not None and found is not None:
            return found
        owner, name, _ = resolve(sys.modules[module], qualname)
        return getattr(owner, name)

    async def _where_is(self, invocation: Invocation, pattern: Pattern | None, quantity: Quantity) -> float:
        """Return the current value of a quantity: ask the robot; for a topic, take the last message.

        Raises Unchanged where a mock or a fake stands in for the robot, and does not tell it.
        """
        own = pattern.current if pattern is not None else None
        reading = self.readings.get(own or self.operation.current or "")
        if reading is None:
            raise LookupError(f"{self.operation.target} names no reading of where {quantity.name} is")
        if reading.named is not None:
            return self._place(reading, quantity, None)
        found = self._other(reading.target, invocation)
        is_own = not callable(found) or (type(found) is not Method and type(unbound(found)) in WRAPPERS)
        try:
            return self._place(reading, quantity, await self._ask(found))
        except Exception as error:
            if isinstance(error, Unchanged) or (is_own and not invocation.where.stands_in):
                raise
            raise Unchanged("a mock or a fake stands here, and does not tell where it is") from error

    def _place(self, reading: Operation, quantity: Quantity, value: Any) -> float:
        """Return the current value of a quantity from what its reading gave, or what last came by."""
        is_named = reading.named is not None
        lately = self.lately.get(reading.target, {})
        for part in reading.readings if is_named else reading.result:
            if is_reading_of(part, quantity):
                number: Any = lately.get(part.name) if is_named else part.path.get(value)
                if number is None and is_named:
                    raise Unchanged("the position of the robot is not known yet")
                return quantity.from_unit(float(number), part.unit) if part.unit else float(number)
        missing = f"no {quantity.axis or 'value'} for a {quantity.kind}"
        raise Unchanged(f"the result of {reading.target} has {missing}: describe it in the vocabulary")

    async def _ask(self, value: Any) -> Any:
        if callable(value):
            self.asks += 1
            value = value()
        return await value if inspect.isawaitable(value) else value

    def last_answer(self, call: Call) -> Reply | None:
        """Return the robot's last answer to this command in the running test.

        It is a copy, so that the program cannot change it, or the object where that cannot be copied safely.
        None if it has not answered yet, or if that object is no more.
        """
        last = self._last_answers.get(call.pattern.text if call.pattern is not None else None)
        found = last(call_context(call)) if last is not None else _GONE
        return Reply({}, found) if found is not _GONE else None

    def _remember(self, call: Call, result: Any) -> None:
        """Store a copy of an answer, without keeping objects of the program alive."""
        key = call.pattern.text if call.pattern is not None else None
        if key not in self.remembers:
            return
        try:
            data = keep(result, call_context(call), self.handles)
        except Exception:  # it cannot be kept, or does anything when it is looked at
            self._last_answers[key] = _weakly(result)
        else:
            self._last_answers[key] = partial(restore, data)


#: stands for an answer that is no more
_GONE = object()


def _weakly(answer: Any) -> Callable[[Mapping[str, Any]], Any]:
    """Return a function that returns an answer as long as the program keeps it."""
    try:
        reference = weakref.ref(answer)
    except TypeError:
        return lambda here: _GONE
    return lambda here: _GONE if (found := reference()) is None else found


def snapshot(value: Any) -> Any:
    """Return a copy of an answer's list or array, which a program may change."""
    if type(value) in _CHANGEABLE or is_of_numpy(value):
        return copy.copy(value)
    return tuple(map(snapshot, value)) if type(value) is tuple else value


def call_context(call: Call) -> dict[str, Any]:
    """Return the names that paths of a call can begin with: the instance as ``self``, and the arguments."""
    invocation: Invocation = call.payload
    known = {} if invocation.instance is None else {"self": invocation.instance}
    return {**(invocation.values or {}), **known}


def handles_of(vocabulary: Vocabulary) -> frozenset[str]:
    """Return the classes that have operations as methods."""
    owners = (operation.target.rpartition(".")[0] for operation in vocabulary.operations)
    return frozenset(owner for owner in owners if ":" in owner)


def _parts(pattern: Pattern) -> tuple[tuple[str, ...], tuple[Quantity, ...]]:
    """Return the names of the described fields of a command's text, and the quantities beside it."""
    fields = pattern.fields
    named = tuple(quantity.name for quantity in pattern.arguments if quantity.name in fields)
    return named, tuple(quantity for quantity in pattern.arguments if quantity.name not in fields)


def _whole_text(message: str | bytes) -> str:
    return message.decode("utf-8", "surrogateescape") if isinstance(message, bytes) else message


def _text(message: Any) -> str | None:
    """Return the text of a message without its line ending; None if it fails to print itself."""
    if isinstance(message, str | bytes):
        return _whole_text(message).rstrip("\r\n")
    try:
        return str(message)
    except Exception:  # an object of the user's may fail in any way
        return None


def _with_text(message: Any, text: str) -> Any:
    """Return the message with another text, and its own line ending."""
    if isinstance(message, int):
        return int(text)
    whole = _whole_text(message)
    text += whole[len(whole.rstrip("\r\n")) :]
    return text.encode("utf-8", "surrogateescape") if isinstance(message, bytes) else text


def _changed_text(pattern: Pattern, call: Call, text: str) -> str:
    """Return the text of the command with the call's values, or that of its opposite."""
    notation = Notation.compile(pattern.notation or "")
    values = {**(notation.read(text) or {}), **call.values}
    if call.reversed and pattern.opposite is not None:
        return Notation.compile(pattern.opposite).write(values, looks=notation.looks(text))
    return notation.write(values, like=text)


def _names(invocation: Invocation, argument: str) -> tuple[str, ...]:
    """Return the names by which a vocabulary may denote the value of an argument."""
    path = Path.parse(argument, rooted=True)
    start = invocation.start_of(path)
    try:
        value = path.get(start) if start is not None else None
    except PathError:
        value = None
    if value is None:
        return ("none",)
    try:
        if is_member(value):
            return (str(value.value), name_of(value))
        if isinstance(value, bytes):
            return (str(value), _whole_text(value))
        whole = (str(int(value)),) if isinstance(value, float) and value.is_integer() else ()
        is_truth = type(value).__name__ in ("bool", "bool_") or value in (0, 1)
        return (*((str(bool(value)).lower(),) if is_truth else ()), *whole, str(value))
    except Exception:  # as above: any object of the user's
        return (f"a {type(value).__name__}",)


def _unread(quantity: Quantity, error: Exception) -> PathError:
    if isinstance(error, PathError):
        return error
    return PathError(f"{quantity.path or 'the result'} cannot be read: {error_text(error)}")


def _strange_value_error(quantity: Quantity, found: Any) -> StrangeValueError:
    """Return an error that says what to describe instead of an object that is no plain data."""
    path, kind = str(quantity.path), class_name(type(found))
    if issubclass(type(found), int) or is_textual(found):
        text = f"no floating-point number can stand for {path or 'the result'}, so its value is left as it is"
        return StrangeValueError(text)
    what = f"{path or 'the result'} is of {kind}, which is not plain data, so its value is left as it is"
    part = next((name for name in ("x", "y", "z") if hasattr(type(found), name)), "magnitude")
    return StrangeValueError(f"{what}; describe the part of it that is a number, such as {path}.{part}")
