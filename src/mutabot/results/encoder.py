"""Objects as JSON-like data, by facts that a line names: ``id file=site.span.file round=round+1``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any

from mutabot.model.codec import is_plain

#: what the facts of a class are, where they are others than its fields: a line, or a function
Facts = Mapping[type, str | Callable[[Any], dict[str, Any]]]


def fact(value: Any, path: Sequence[str]) -> Any:
    """Return the attribute at a path such as ``("site", "span", "file")``; None if a step is None."""
    for name in path:
        if value is None:
            return None
        value = getattr(value, name)
    return value


class Encoder:
    """Converts objects to JSON-like data. None fields are left out of classes without a line of facts.

    A line of facts has words for attributes: ``name``, ``key=path`` for another name, ``*path`` for all facts
    of what is there, and ``*`` for the fields. ``path+1`` counts from 1, ``path?`` is null where it is empty,
    ``path#`` is a list whose items have their number as ``round``.
    """

    def __init__(self, known: Facts) -> None:
        self._known = known

    def __call__(self, value: Any) -> Any:
        """Return the data of any value."""
        if is_plain(value):
            return value
        known = self._known.get(type(value))
        if known is not None:
            return self.facts(value, known) if isinstance(known, str) else known(value)
        if isinstance(value, Enum):
            return value.value
        if isinstance(value, Mapping):
            return {str(key): self(item) for key, item in value.items()}
        if isinstance(value, tuple | list):
            return [self(item) for item in value]
        return self._fields(value) if is_dataclass(value) else value

    def facts(self, value: object, line: str) -> dict[str, Any]:
        """Return the facts of an object that a line names, in its order."""
        found: dict[str, Any] = {}
        for key, path, kind in _words(line):
            if kind == "*":
                found |= self(fact(value, path)) if path else self._fields(value)
            else:
                found[key] = self._fact(fact(value, path), kind)
        return found

    def _fact(self, value: Any, kind: str) -> Any:
        if kind == "+1":
            return value + 1
        if kind == "#":
            items = enumerate(map(self, value), start=1)
            return [{"round": number, **(item or {"verdict": None})} for number, item in items]
        return None if kind == "?" and not value else self(value)

    def _fields(self, value: Any) -> dict[str, Any]:
        pairs = ((own_field.name, getattr(value, own_field.name)) for own_field in fields(value))
        return {name: self(item) for name, item in pairs if item is not None}


@cache
def _words(line: str) -> tuple[tuple[str, tuple[str, ...], str], ...]:
    """Parse a line of facts: for each word the key, the path and the conversion."""
    found: list[tuple[str, tuple[str, ...], str]] = []
    for word in line.split():
        if word.startswith("*"):
            found.append(("", tuple(word[1:].split(".")) if word[1:] else (), "*"))
            continue
        name, _, path = word.rpartition("=")
        kind = next((marker for marker in ("+1", "?", "#") if path.endswith(marker)), "")
        path = path.removesuffix(kind)
        found.append((name or path, tuple(path.split(".")), kind))
    return tuple(found)
