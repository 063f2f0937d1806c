"""Checks that the types in a vocabulary are installed and have the fields that it describes."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fnmatch import fnmatchcase
from importlib import import_module
from types import ModuleType
from typing import Any, ClassVar

from mutabot.api.values import Finding, Form, Operation, Path

#: the tables of the vocabulary in which the fields are described of what is written, and of what is read
_TABLES: Mapping[Form, tuple[str, str]] = {
    Form.PUBLISH: ("fields", ""),
    Form.RECEIVE: ("", "fields"),
    Form.CALL: ("request", "response"),
    Form.GOAL: ("goal", ""),
    Form.FEEDBACK: ("", "feedback"),
    Form.RESULT: ("", "result"),
    Form.TRANSFORM: ("", "fields"),
}
_KINDS = {"msg": "messages", "srv": "services", "action": "actions"}


class Types(ABC):
    """The types that the program uses for its names, and access to a middleware's type definitions.

    Attributes:
        written, read: where the definition stands of what is written, and of what is read: the module of a
            package, and the part of the type.
        array: a type that is several of something, its group ``item``.
        as_goal: uses of an action that are known by the type of its goal.
    """

    written: ClassVar[Mapping[Form, tuple[str, str]]]
    read: ClassVar[Mapping[Form, tuple[str, str]]]
    array: ClassVar[re.Pattern[str]]
    as_goal: ClassVar[frozenset[Form]] = frozenset()

    def __init__(self) -> None:
        self._used: dict[tuple[Form, str], str] = {}

    def clear(self) -> None:
        """Forget all types that the program uses."""
        self._used.clear()

    def note(self, form: Form, name: str, kind: Any) -> None:
        """Record that a name is used with a class of messages, of a service or of an action."""
        type_name = self.name_of(kind)
        if type_name is not None:
            self._used[form, name] = type_name

    def of(self, form: Form, names: str) -> dict[str, str]:
        """Return the types used in a form, by name; ``*`` in ``names`` matches any text."""
        wanted = Form.GOAL if form in self.as_goal else form
        return {
            name: kind
            for (used, name), kind in self._used.items()
            if used is wanted and fnmatchcase(name, names)
        }

    def check(self, operation: Operation) -> Iterator[Finding]:
        """Yield what in an operation does not fit the installed definition of its type.

        Where the vocabulary names no type, it is the one that the program uses.
        """
        named = operation.named
        if named is None:
            return
        used = self.of(named.form, named.name)
        for kind in [named.type] if named.type is not None else sorted(set(used.values())):
            yield from self._check_fields(operation, named.form, kind)
        yield from self._check_refusals(operation)
        for name, kind in used.items():
            if named.type not in (None, kind):
                yield Finding("type", f"the program uses {kind} for {name}", named.type, (kind,))

    @abstractmethod
    def name_of(self, kind: Any) -> str | None:
        """Return ``package/Name`` of a class; None if it is not a class of the middleware."""

    @abstractmethod
    def part_of(self, module: ModuleType, name: str, part: str) -> Any:
        """Return the class of a part of a type, or of the whole type; None if the module has no such type."""

    @abstractmethod
    def names_in(self, module: ModuleType, part: str) -> Iterator[str]:
        """Yield the types in a module that have such a part."""

    @abstractmethod
    def fields_of(self, message: Any) -> Mapping[str, str]:
        """Return the types of a message class's fields, by name."""

    def packages(self) -> Iterator[str]:
        """Yield the packages with type definitions, as far as they are known."""
        return iter(())

    def fields_of_basic(self, kind: str) -> Mapping[str, str]:
        """Return the fields of a type that no package defines."""
        return {}

    def _check_fields(self, operation: Operation, form: Form, kind: str) -> Iterator[Finding]:
        sides = ((self.written, 0, operation.arguments), (self.read, 1, operation.result))
        for places, side, quantities in sides:
            if form not in places:
                continue
            try:
                message = self._class_of(kind, *places[form])
            except LookupError as error:
                text, name, known = error.args
                yield Finding("type", text, name, known)
                return
            for quantity in quantities:
                if operation.is_field(quantity):
                    key = f"{_TABLES[form][side]}.{quantity.name}"
                    yield from self._check_path(message, quantity.path, key)
            for refused in operation.all_refused if places is self.read else ():
                if refused.topic is None:
                    yield from self._check_path(message, refused.parsed, "refused.path")

    def _check_refusals(self, operation: Operation) -> Iterator[Finding]:
        """Check the vocabulary's refusals on topics whose types are known."""
        for refused in operation.all_refused:
            listened = {} if refused.topic is None else self.of(Form.RECEIVE, refused.topic)
            for name, kind in listened.items():
                try:
                    message = self._class_of(kind, *self.read[Form.RECEIVE])
                except LookupError:  # the program has it all the same
                    continue
                for finding in self._check_path(message, refused.parsed, "refused.path"):
                    yield replace(finding, text=f"{name}: {finding.text}")

    def _class_of(self, kind: str, module: str, part: str) -> Any:
        """Return the class of a type. Raises LookupError with a message, the wrong name and known names."""
        package, _, name = kind.partition("/")
        try:
            found = import_module(f"{package}.{module}")
        except ImportError:
            text = f"{kind}: no package {package!r} with {_KINDS[module]} is installed"
            raise LookupError(text, package, tuple(self.packages())) from None
        message = self.part_of(found, name, part)
        if message is None:
            text = f"{package} has no {name} among its {_KINDS[module]}"
            raise LookupError(text, name, tuple(self.names_in(found, part)))
        return message

    def _check_path(self, message: Any, path: Path, key: str) -> Iterator[Finding]:
        """Yield what in a path does not fit a message class."""
        kind, fields = self.name_of(message), self.fields_of(message)
        for step in path.steps:
            if step.attribute is None:
                item = self.array.fullmatch(kind or "")
                if item is None:
                    yield Finding(key, f"{kind} is not an array, so it has no {step}")
                    return
                kind = kind if step.bounds is not None else item["item"]
            elif step.attribute in fields:
                kind = fields[step.attribute]
            else:
                hint = f"; it has {', '.join(fields)}" if fields else ""
                text = f"{kind} has no field {step.attribute!r}{hint}"
                yield Finding(key, text, step.attribute, tuple(fields))
                return
            fields = self._fields_named(kind or "")

    def _fields_named(self, kind: str) -> Mapping[str, str]:
        if "/" not in kind or self.array.fullmatch(kind):
            return self.fields_of_basic(kind)
        return self.fields_of(self._class_of(kind, "msg", ""))
