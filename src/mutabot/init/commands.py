"""Commands that a text, or a node, register or name, tells apart: patterns, and what stands beside them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from mutabot.model.watched import Command, WatchedCallable, WatchedPart

from .guess import Guess, NameContext, guess_argument, guess_reading
from .layout import with_compared
from .words import OPPOSITES, words_of

#: names of arguments that hold a text command
MESSAGES = frozenset({"message", "command", "cmd", "msg", "text", "line", "order"})
_NUMBER = re.compile(r"(?<![\w{])[-+]?\d+(?:\.\d+)?(?!\w)")
_FIELD = re.compile(r"\{(\w+):g\}")
_FIELDS = {"lift": "height", "drop": "height", "turn": "angle", "rotate": "angle", "wait": "seconds"}
_READS = re.compile(r"(?:^|_)(?:read|get)", re.IGNORECASE)
#: arguments that say how to write rather than what
_HOW = frozenset({"timeout", "wait", "device_id", "slave", "unit", "no_response_expected", "count", "qos"})
#: more different numbers than these are no settings, but a scale
_MOST_VALUES = 5


def patterns_of(texts: Sequence[str]) -> list[tuple[str, Guess]]:
    """Notations that take these texts, each with what its only field means (empty without a field)."""
    notations: dict[str, list[float]] = {}
    for text in filter(str.strip, texts):
        numbers = [float(number) for number in _NUMBER.findall(text)]
        notations.setdefault(_notation(text), []).extend(numbers)
    found = []
    for notation, numbers in notations.items():
        guess = Guess()
        if len(_FIELD.findall(notation)) == 1:
            words = words_of(_FIELD.sub("", notation))
            guess = guess_argument("value", NameContext(words, values=numbers))
        opposite = _opposite(notation, list(notations))
        if opposite is not None:
            guess.table["opposite"] = opposite
        found.append((notation, guess))
    return found


def _notation(text: str) -> str:
    if _FIELD.search(text):
        return text
    words = re.findall(r"[a-z]+", text.lower())
    name = next((word for word in words if word not in ("to", "by")), "value")
    literal = text.replace("{", "{{").replace("}", "}}")
    if len(_NUMBER.findall(literal)) == 1:
        return _NUMBER.sub(lambda _: "{" + _FIELDS.get(name, "value") + ":g}", literal)
    fields = iter(range(1, 100))
    return _NUMBER.sub(lambda _: f"{{value{next(fields)}:g}}", literal)


def _opposite(notation: str, known: Sequence[str]) -> str | None:
    for pair in OPPOSITES:
        for one, other in (pair, pair[::-1]):
            swapped = re.sub(rf"\b{one}\b", other, notation)
            if swapped != notation and swapped in known:
                return swapped
    return None


def tells_commands(call: WatchedCallable) -> bool:
    """Whether there are commands, and their texts look like names of something."""
    if not call.commands:
        return False
    return call.told_by != "self" or len(call.commands) > 1 or "=" in next(iter(call.commands))


def is_read(call: WatchedCallable) -> bool:
    """Whether its commands read."""
    return _READS.search(call.name) is not None


def commands_of(call: WatchedCallable, groups: Sequence[Sequence[Any]] = ()) -> list[tuple[str, Guess]]:
    """Each command as a notation, with what is written beside it or read.

    ``groups``: constants that the program compares one and the same thing with.
    """
    found = []
    for text, command in call.commands.items():
        table = _read(text, command, groups) if is_read(call) else _written(text, command)
        notation = text.replace("{", "{{").replace("}", "}}")
        found.append((notation, Guess(table, note=_seen(command, is_read(call)))))
    return found


def _written(text: str, command: Command) -> dict[str, Any]:
    tables = {}
    for name, values in command.arguments.items():
        part = values.parts.get(name)
        table = _value(text, part) if name not in _HOW and part is not None and values.always(part) else {}
        if table:
            tables[name] = table
    return {"arguments": tables} if tables else {}


def _value(text: str, part: WatchedPart) -> dict[str, Any]:
    """What a written value means: as the node is called, else as its values look."""
    values = list(part.values)
    if part.length is not None or not values or any(isinstance(value, str) for value in values):
        return {}
    if all(isinstance(value, bool) for value in values):
        return {"kind": "output", "values": [False, True]}
    words = words_of(text)
    guess = guess_argument((words or ("",))[-1], NameContext((*words[:-1], "set"), values=values))
    if guess.is_sure and guess.table["kind"] in ("translation", "rotation", "duration"):
        return guess.table
    return {"kind": "output", "values": values} if 2 <= len(values) <= _MOST_VALUES else {}


def _read(text: str, command: Command, groups: Sequence[Sequence[Any]]) -> dict[str, Any]:
    part = command.result.parts.get("")
    if part is None or not command.result.always(part) or part.length is not None or not part.values:
        return {}
    if part.type == "bool":
        return {"result": {"kind": "flag"}}
    words = words_of(text)
    annotation = "str" if part.type == "str" else ""
    setting = NameContext(words, annotation=annotation, values=with_compared(part.values, groups))
    guess = guess_reading((words or ("",))[-1], setting)
    return {"result": guess.table} if guess.is_sure else {}


def _seen(command: Command, reads: bool) -> str:
    several = [command.result] if reads else list(command.arguments.values())
    shown = [str(value) for values in several for part in values.parts.values() for value in part.values]
    return ", ".join(shown[:4]) + (", …" if len(shown) > 4 else "")
