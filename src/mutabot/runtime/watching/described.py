"""What was seen of values and calls, in words that need no import.

Plain numbers, texts and sequences stand by path; calls are told apart by a node, register or name, and the
values beside it.
"""

from __future__ import annotations

import dataclasses
import enum
import re
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

#: different values that are kept of each part
MOST_VALUES = 8
#: elements of a sequence that are kept, and parts of an object
MOST_ELEMENTS, MOST_PARTS = 16, 24
_DEPTH = 3
#: parts of an object that is no declared record but may be one
_MOST_FIELDS = 12


@dataclass
class Leaf:
    """A part of an argument or result.

    Attributes:
        path: where it lies, as vocabularies write it.
        name: the last name on the way; empty for an index or the value itself.
        doc: what the class that holds it says about itself.
        values: the first different values; sequences of numbers as lists.
        length: number of elements of a sequence, the least that was seen; None for anything else.
        type: name of its type.
        count: in how many calls it was there.
    """

    path: str
    name: str = ""
    doc: str = ""
    values: list[Any] = field(default_factory=list)
    length: int | None = None
    type: str = ""
    count: int = 0


class Leaves:
    """The parts of one argument or result, over all calls."""

    def __init__(self) -> None:
        self.found: dict[str, Leaf] = {}

    def see(self, value: Any, root: str = "") -> None:
        """One more value."""
        for leaf in _parts(value, Leaf(root), _DEPTH):
            note(self.found, leaf)

    def data(self) -> list[dict[str, Any]]:
        """For JSON."""
        return [dataclasses.asdict(leaf) for leaf in self.found.values()]


def note(found: dict[str, Any], part: Any) -> None:
    """One more value has this part: add it to what was seen of the part before, by path."""
    known = found.setdefault(part.path, part)
    known.count += 1
    if part.length is not None and known.length is not None:
        known.length = min(part.length, known.length)
    for one in part.values:
        is_new = all(one != other or type(one) is not type(other) for other in known.values)
        if is_new and len(known.values) < MOST_VALUES:
            known.values.append(one)


def of_type(hint: Any, depth: int = 2) -> list[Leaf]:
    """The parts that a type promises."""
    return list(_promised(hint, Leaf(""), depth))


def _parts(value: Any, leaf: Leaf, depth: int) -> Iterator[Leaf]:
    value = _plain(value)
    leaf.type = type(value).__name__
    if value is None:
        return
    if isinstance(value, bool | int | float | str):
        leaf.values = [value[:80] if isinstance(value, str) else value]
        yield leaf
    elif isinstance(value, enum.Enum) or depth == 0:
        yield leaf
    elif isinstance(value, list | tuple) and not hasattr(type(value), "_fields"):
        yield from _elements(value, leaf, depth)
    else:
        named = list(_named(value))[:MOST_PARTS]
        doc = type(value).__doc__ or ""
        for step, name, part in named:
            inner = Leaf(f"{leaf.path}{step}", name, doc[:300])
            yield from _parts(part, inner, depth - 1)
        if not named:
            yield leaf


def _elements(value: Any, leaf: Leaf, depth: int) -> Iterator[Leaf]:
    items = [_plain(one) for one in value[:MOST_ELEMENTS]]
    if items and all(isinstance(one, int | float) and not isinstance(one, bool) for one in items):
        leaf.length, leaf.values = len(value), [items]
        yield leaf
        return
    for index, item in enumerate(items[:8]):
        yield from _parts(item, Leaf(f"{leaf.path}[{index}]", "", leaf.doc), depth - 1)


def _plain(value: Any) -> Any:
    """Arrays and scalars of numeric libraries as Python has them, if they are small enough."""
    if hasattr(type(value), "tolist") and getattr(value, "size", 0) <= 4096:
        return value.tolist()
    return value


def _named(value: Any) -> Iterator[tuple[str, str, Any]]:
    """Step, name and value of the parts of an object that have names."""
    if isinstance(value, Mapping):
        for key, part in list(value.items())[:MOST_PARTS]:
            if isinstance(key, str) and '"' not in key and "]" not in key:
                yield f'["{key}"]', key, part
        return
    if isinstance(value, type) or callable(value):
        return
    names: Any = getattr(type(value), "_fields", None)  # the type's: a mock has any attribute
    if names is None and not dataclasses.is_dataclass(value) and not _is_data(value):
        return
    if names is None:
        names = vars(value) if hasattr(value, "__dict__") else getattr(type(value), "__slots__", ())
    for name in [names] if isinstance(names, str) else list(names):
        if not name.startswith("_") and hasattr(value, name):
            yield f".{name}", name, getattr(value, name)


def _is_data(value: Any) -> bool:
    """Whether an object does little more than hold plain values, as a pose or a message does."""
    parts = vars(value).values() if hasattr(value, "__dict__") else ()
    slots = hasattr(type(value), "__slots__") and not parts
    return slots or (0 < len(parts) <= _MOST_FIELDS and all(_is_plain_part(part) for part in parts))


def _is_plain_part(part: Any) -> bool:
    part = _plain(part)
    if isinstance(part, list | tuple):
        return len(part) <= MOST_ELEMENTS and all(_is_plain_part(one) for one in part)
    return isinstance(part, bool | int | float | str | None | enum.Enum) or dataclasses.is_dataclass(part)


def _promised(hint: Any, leaf: Leaf, depth: int) -> Iterator[Leaf]:
    arguments = [one for one in typing.get_args(hint) if one is not type(None)]
    if typing.get_origin(hint) is tuple:
        if arguments and all(one in (int, float) for one in arguments):
            leaf.length = len(arguments)
            yield leaf
        return
    if arguments and not isinstance(hint, type):
        hint = arguments[0]  # Optional, Annotated
    if not isinstance(hint, type) or hint in (int, float, bool, str, object):
        yield leaf
        return
    if depth and (dataclasses.is_dataclass(hint) or hasattr(hint, "_fields")):
        for name, inner in _hints(hint).items():
            part = Leaf(f"{leaf.path}.{name}", name, (hint.__doc__ or "")[:300])
            yield from _promised(inner, part, depth - 1)
    else:
        yield leaf


def _hints(of: Any) -> dict[str, Any]:
    try:
        return typing.get_type_hints(of)
    except Exception:  # a name in an annotation that does not exist while the program runs
        return {}


#: names of arguments that tell which command a call is
_NAMES = frozenset(
    "node node_id nodeid name address register tag channel signal topic variable".split()  # noqa: SIM905
)
_TALKS = re.compile(r"(?:^|_)(?:read|write|get|set|send|publish)(?:_|$)", re.IGNORECASE)
#: more commands than these, and longer texts, are no list of commands
_MOST, _LONGEST = 24, 60


@dataclass
class _Command:
    """What was seen of one command."""

    calls: int = 0
    given: dict[str, Leaves] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    result: Leaves = field(default_factory=Leaves)
    answered: int = 0


@dataclass
class ToldApart:
    """The commands of one callable.

    Attributes:
        by: path to what tells them apart, as vocabularies write it; empty if nothing does.
        commands: what was seen of each.
    """

    by: str = ""
    commands: dict[str, _Command] = field(default_factory=dict)
    _given_up: bool = False

    def see(self, instance: Any, target: str, values: Mapping[str, Any]) -> str | None:
        """One more call; the text of what tells which command it is."""
        if self._given_up:
            return None
        by, text = self._which(instance, target, values)
        if not by or (self.by and by != self.by) or len(text) > _LONGEST or len(self.commands) > _MOST:
            self._given_up, self.by = True, ""
            self.commands.clear()
            return None
        self.by = by
        command = self.commands.setdefault(text, _Command())
        command.calls += 1
        for name, value in values.items():
            if name != by:
                command.counts[name] = command.counts.get(name, 0) + 1
                command.given.setdefault(name, Leaves()).see(value, name)
        return text

    def answer(self, text: str | None, result: Any) -> None:
        """What such a call answered."""
        if text in self.commands:
            self.commands[text].answered += 1
            self.commands[text].result.see(result)

    def data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "by": self.by,
            "commands": {
                text: {
                    "calls": command.calls,
                    "given": command.counts,
                    "arguments": {name: leaves.data() for name, leaves in command.given.items()},
                    "answered": command.answered,
                    "result": command.result.data(),
                }
                for text, command in self.commands.items()
            },
        }

    def _which(self, instance: Any, target: str, values: Mapping[str, Any]) -> tuple[str, str]:
        """Path and text of what tells this call's command; empty texts if nothing does."""
        if not _TALKS.search(re.split(r"[.:]", target)[-1]):
            return "", ""
        for name, value in values.items():
            is_plain = isinstance(value, str | int) and not isinstance(value, bool)
            if name.lower() in _NAMES and (is_plain or _prints_itself(value)):
                return name, str(value)
        return ("self", str(instance)) if _prints_itself(instance) else ("", "")


def _prints_itself(value: Any) -> bool:
    """Whether an object prints as a name of its own, as a node does by its id."""
    own: Any = type(value).__str__
    if value is None or own is object.__str__ or not hasattr(value, "__dict__"):
        return False
    text = str(value)
    return "\n" not in text and " object at " not in text
