"""What a call writes: which command it is, the values it gives, and the same call with other values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from mutabot.errors import PathError
from mutabot.model import Call, Operation, Pattern, Quantity
from mutabot.model.values.members import is_member, name_of
from mutabot.model.values.notation import Notation
from mutabot.model.values.path import Path
from mutabot.model.values.quantity import Value

from .arguments import Arguments


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
