"""Types of ROS 1: whether those a vocabulary names are installed, and have the fields it describes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase
from importlib import import_module
from pathlib import Path as File
from typing import Any

from mutabot.inside.targets.target import Finding
from mutabot.model import Operation, Path
from mutabot.model.named import Form, Named
from mutabot.model.values.path import Step

_ARRAY = re.compile(r"(?P<item>.+)\[\d*\]")
_MOMENTS = frozenset({"time", "duration"})
_PARTS_OF_MOMENTS = ("secs", "nsecs")

#: where the definition of what is written stands, and of what is read: the module, and what follows the name
_WRITTEN: Mapping[Form, tuple[str, str]] = {
    Form.PUBLISH: ("msg", ""),
    Form.CALL: ("srv", "Request"),
    Form.GOAL: ("msg", "Goal"),
}
_READ: Mapping[Form, tuple[str, str]] = {
    Form.RECEIVE: ("msg", ""),
    Form.CALL: ("srv", "Response"),
    Form.FEEDBACK: ("msg", "Feedback"),
    Form.RESULT: ("msg", "Result"),
    Form.TRANSFORM: ("msg", ""),
}
#: the tables of the vocabulary in which fields are described
_TABLES: Mapping[Form, tuple[str, str]] = {
    Form.PUBLISH: ("fields", ""),
    Form.RECEIVE: ("", "fields"),
    Form.CALL: ("request", "response"),
    Form.GOAL: ("goal", ""),
    Form.FEEDBACK: ("", "feedback"),
    Form.RESULT: ("", "result"),
    Form.TRANSFORM: ("", "fields"),
}


class Seen:
    """The types that programs give the names they use."""

    def __init__(self) -> None:
        self._types: dict[tuple[Form, str], str] = {}

    def clear(self) -> None:
        """Forget all of them."""
        self._types.clear()

    def note(self, form: Form, name: str, kind: Any) -> None:
        """A name is used with a class of messages, of a service or an action."""
        type_name = getattr(kind, "_type", None)
        if isinstance(type_name, str):
            self._types[form, name] = type_name.removesuffix("Action")

    def of(self, named: Named) -> dict[str, str]:
        """The types of all names that are meant, by name."""
        return {
            name: kind
            for (form, name), kind in self._types.items()
            if form is named.form and fnmatchcase(name, named.name)
        }


def look_at(operation: Operation, seen: Seen) -> Iterator[Finding]:
    """What of an operation does not fit the installed definition of its type.

    Where the vocabulary names no type, it is the one that the program uses.
    """
    named = operation.named
    if named is None:
        return
    used = seen.of(named)
    for kind in [named.type] if named.type is not None else sorted(set(used.values())):
        yield from _fields(operation, named.form, kind)
    for name, kind in used.items():
        if named.type not in (None, kind):
            yield Finding("type", f"the program uses {kind} for {name}", named.type, (kind,))


def _fields(operation: Operation, form: Form, kind: str) -> Iterator[Finding]:
    sides = ((_WRITTEN, 0, operation.arguments), (_READ, 1, operation.result))
    for places, side, quantities in sides:
        if form not in places:
            continue
        module, ending = places[form]
        try:
            message = _class_of(kind, module, ending)
        except LookupError as error:
            text, name, known = error.args
            yield Finding("type", text, name, known)
            return
        for quantity in quantities:
            key = f"{_TABLES[form][side]}.{quantity.name}"
            yield from _steps(message, quantity.path, key)


def _class_of(kind: str, module: str, ending: str) -> Any:
    """The class of a type. Raises LookupError: a sentence, the wrong name, and those there are."""
    package, _, name = kind.partition("/")
    try:
        found = import_module(f"{package}.{module}")
    except ImportError:
        text = f"{kind}: no package {package!r} with {_KINDS[module]} is installed"
        raise LookupError(text, package, tuple(_packages())) from None
    if hasattr(found, name + ending):
        return getattr(found, name + ending)
    known = tuple(
        one.removesuffix(ending) for one in vars(found) if one.endswith(ending) and one[0].isupper()
    )
    raise LookupError(f"{package} has no {name} among its {_KINDS[module]}", name, known)


_KINDS = {"msg": "messages", "srv": "services"}


def _packages() -> Iterator[str]:
    """Packages of messages beside one that is surely there."""
    std_msgs = import_module("std_msgs")
    for folder in (File(place).parent for place in std_msgs.__path__):
        for path in folder.iterdir():
            if (path / "msg").is_dir() or (path / "srv").is_dir():
                yield path.name


def _steps(message: Any, path: Path, key: str) -> Iterator[Finding]:
    """What of a path does not fit a class of messages."""
    kind, fields = message._type, _slots(message)
    for step in path.steps:
        if step.attribute is None:
            item = _ARRAY.fullmatch(kind)
            if item is None:
                yield Finding(key, f"{kind} is no array, so it has no {step}")
                return
            kind = kind if _is_slice(step) else item["item"]
        elif step.attribute in fields:
            kind = fields[step.attribute]
        else:
            hint = f"; it has {', '.join(fields)}" if fields else ""
            text = f"{kind} has no field {step.attribute!r}{hint}"
            yield Finding(key, text, step.attribute, tuple(fields))
            return
        fields = _fields_of(kind)


def _is_slice(step: Step) -> bool:
    return step.bounds is not None


def _fields_of(kind: str) -> dict[str, str]:
    if kind in _MOMENTS:
        return dict.fromkeys(_PARTS_OF_MOMENTS, "int32")
    if "/" not in kind or _ARRAY.fullmatch(kind):
        return {}
    return _slots(_class_of(kind, "msg", ""))


def _slots(message: Any) -> dict[str, str]:
    return dict(zip(message.__slots__, message._slot_types, strict=True))
