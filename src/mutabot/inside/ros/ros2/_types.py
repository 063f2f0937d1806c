"""Types of ROS 2: whether those a vocabulary names are installed, and have the fields it describes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase
from importlib import import_module
from typing import Any

from mutabot.inside.targets.target import Finding
from mutabot.model import Operation, Path
from mutabot.model.named import WRITTEN, Form, Named

#: ``sequence<double, 3>``, ``double[9]``: several of something
_SEVERAL = re.compile(r"sequence<(?P<item>[^,>]+)(?:,\s*\d+)?>|(?P<fixed>[^\[]+)\[[^\]]*\]")

#: where the definition of what is written stands, and of what is read: the module, and the part of the type
_WRITTEN: Mapping[Form, tuple[str, str | None]] = {
    Form.PUBLISH: ("msg", None),
    Form.CALL: ("srv", "Request"),
    Form.GOAL: ("action", "Goal"),
}
_READ: Mapping[Form, tuple[str, str | None]] = {
    Form.RECEIVE: ("msg", None),
    Form.CALL: ("srv", "Response"),
    Form.FEEDBACK: ("action", "Feedback"),
    Form.RESULT: ("action", "Result"),
}
#: the tables of the vocabulary in which fields are described
_TABLES: Mapping[Form, tuple[str, str]] = {
    Form.PUBLISH: ("fields", ""),
    Form.RECEIVE: ("", "fields"),
    Form.CALL: ("request", "response"),
    Form.GOAL: ("goal", ""),
    Form.FEEDBACK: ("", "feedback"),
    Form.RESULT: ("", "result"),
}
_KINDS = {"msg": "messages", "srv": "services", "action": "actions"}
#: uses of an action are known by that of its goal
_AS_GOAL = frozenset({Form.FEEDBACK, Form.RESULT, Form.CANCEL})


class Seen:
    """The types that programs give the names they use."""

    def __init__(self) -> None:
        self._types: dict[tuple[Form, str], str] = {}

    def clear(self) -> None:
        """Forget all of them."""
        self._types.clear()

    def note(self, form: Form, name: str, kind: Any) -> None:
        """A name is used with a class of messages, of a service or an action."""
        if isinstance(kind, type):
            self._types[form, name] = f"{kind.__module__.partition('.')[0]}/{kind.__name__}"

    def of(self, named: Named) -> dict[str, str]:
        """The types of all names that are meant, by name."""
        wanted = Form.GOAL if named.form in _AS_GOAL else named.form
        return {
            name: kind
            for (form, name), kind in self._types.items()
            if form is wanted and fnmatchcase(name, named.name)
        }


#: those of this process
seen = Seen()


def look_at(operation: Operation) -> Iterator[Finding]:
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
        module, part = places[form]
        try:
            message = _class_of(kind, module, part)
        except LookupError as error:
            text, name, known = error.args
            yield Finding("type", text, name, known)
            return
        for quantity in quantities:
            if quantity.path.root not in (None, WRITTEN.get(form)):
                continue  # no field of the message
            yield from _steps(message, quantity.path, f"{_TABLES[form][side]}.{quantity.name}")


def _class_of(kind: str, module: str, part: str | None) -> Any:
    """The class of a type. Raises LookupError: a sentence, the wrong name, and those there are."""
    package, _, name = kind.partition("/")
    try:
        found = import_module(f"{package}.{module}")
    except ImportError:
        text = f"{kind}: no package {package!r} with {_KINDS[module]} is installed"
        raise LookupError(text, package, ()) from None
    whole = getattr(found, name, None)
    if whole is None:
        known = tuple(one for one in vars(found) if one[0].isupper() and "_" not in one)
        raise LookupError(f"{package} has no {name} among its {_KINDS[module]}", name, known)
    return whole if part is None else getattr(whole, part)


def _steps(message: Any, path: Path, key: str) -> Iterator[Finding]:
    """What of a path does not fit a class of messages."""
    kind, fields = _name_of(message), message.get_fields_and_field_types()
    for step in path.steps:
        if step.attribute is None:
            several = _SEVERAL.fullmatch(kind)
            if several is None:
                yield Finding(key, f"{kind} is no array, so it has no {step}")
                return
            kind = kind if step.bounds is not None else several["item"] or several["fixed"]
        elif step.attribute in fields:
            kind = fields[step.attribute]
        else:
            hint = f"; it has {', '.join(fields)}" if fields else ""
            text = f"{kind} has no field {step.attribute!r}{hint}"
            yield Finding(key, text, step.attribute, tuple(fields))
            return
        fields = _fields_of(kind)


def _fields_of(kind: str) -> Mapping[str, str]:
    if "/" not in kind or _SEVERAL.fullmatch(kind):
        return {}
    fields: Mapping[str, str] = _class_of(kind, "msg", None).get_fields_and_field_types()
    return fields


def _name_of(message: Any) -> str:
    return f"{message.__module__.partition('.')[0]}/{message.__name__}"
