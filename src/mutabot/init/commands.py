"""Commands that a text, or a node, register or name, tells apart: patterns, and what stands beside them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from mutabot.init.compared import with_compared
from mutabot.init.guess import Guess, Setting, guess_argument, guess_reading
from mutabot.init.observed import Part, SeenCall, SeenCommand

#: names of arguments that hold a text command
MESSAGES = frozenset({"message", "command", "cmd", "msg", "text", "line", "order"})
_NUMBER = re.compile(r"(?<![\w{])[-+]?\d+(?:\.\d+)?(?!\w)")
_FIELD = re.compile(r"\{(\w+):g\}")
_OPPOSITES = (
    ("lift", "drop"), ("raise", "lower"), ("up", "down"), ("pick", "release"), ("grip", "release"),
    ("grasp", "release"), ("open", "close"), ("on", "off"), ("forward", "back"), ("left", "right"),
    ("start", "stop"),
)  # fmt: skip
_MEANINGS = (
    (
        ("lift", "drop", "raise", "lower", "up", "down"),
        {"kind": "translation", "axis": "z", "unit": "m", "mode": "by"},
    ),
    (
        ("turn", "rotate", "yaw", "left", "right"),
        {"kind": "rotation", "axis": "z", "unit": "deg", "mode": "by"},
    ),
    (("move", "forward", "back", "go", "shift"), {"kind": "translation", "unit": "m", "mode": "by"}),
    (("wait", "sleep", "pause"), {"kind": "duration", "unit": "s"}),
)


def patterns_of(texts: Sequence[str]) -> list[tuple[str, Guess]]:
    """Notations that take these texts, each with what its only field means (empty without a field)."""
    notations = dict.fromkeys(_notation(text) for text in texts if text.strip())
    found = []
    for notation in notations:
        guess = _meaning(notation)
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
    fields = iter(range(1, 100))
    literal = text.replace("{", "{{").replace("}", "}}")
    if len(_NUMBER.findall(literal)) == 1:
        return _NUMBER.sub(lambda _: "{" + _field_name(name) + ":g}", literal)
    return _NUMBER.sub(lambda _: f"{{value{next(fields)}:g}}", literal)


def _field_name(word: str) -> str:
    return {"lift": "height", "drop": "height", "turn": "angle", "rotate": "angle", "wait": "seconds"}.get(
        word, "value"
    )


def _meaning(notation: str) -> Guess:
    if len(_FIELD.findall(notation)) != 1:
        return Guess()
    words = set(re.findall(r"[a-z]+", _FIELD.sub("", notation).lower()))
    for names, table in _MEANINGS:
        if words & set(names):
            absolute = "mode" in table and "to" in words
            return Guess({**table, **({"mode": "to"} if absolute else {})}, ["unit and mode"])
    return Guess()


def _opposite(notation: str, known: Sequence[str]) -> str | None:
    for pair in _OPPOSITES:
        for one, other in (pair, pair[::-1]):
            swapped = re.sub(rf"\b{one}\b", other, notation)
            if swapped != notation and swapped in known:
                return swapped
    return None


_READS = re.compile(r"(?:^|_)(?:read|get)", re.IGNORECASE)
#: arguments that say how to write rather than what
_HOW = frozenset({"timeout", "wait", "device_id", "slave", "unit", "no_response_expected", "count", "qos"})
#: more different numbers than these are no settings, but a scale
_MOST_VALUES = 5


def tells_commands(call: SeenCall) -> bool:
    """Whether there are commands, and their texts look like names of something."""
    if not call.commands:
        return False
    return call.told_by != "self" or len(call.commands) > 1 or "=" in call.commands[0].text


def is_read(call: SeenCall) -> bool:
    """Whether its commands read."""
    return _READS.search(call.name) is not None


def commands_of(call: SeenCall, groups: Sequence[Sequence[Any]] = ()) -> list[tuple[str, Guess]]:
    """Each command as a notation, with what is written beside it or read.

    ``groups``: constants that the program compares one and the same thing with.
    """
    found = []
    for command in call.commands:
        table = _read(command, groups) if is_read(call) else _written(command)
        notation = command.text.replace("{", "{{").replace("}", "}}")
        found.append((notation, Guess(table, [], _seen(command, is_read(call)))))
    return found


def _written(command: SeenCommand) -> dict[str, Any]:
    tables = {}
    for name, parts in command.arguments.items():
        for part in parts:
            if name not in _HOW and part.path == name and part.always:
                table = _value(command, name, part)
                if table:
                    tables[name] = table
    return {"arguments": tables} if tables else {}


def _value(command: SeenCommand, name: str, part: Part) -> dict[str, Any]:
    """What a written value means: as the node is called, else as its values look."""
    values = list(part.values)
    if part.length is not None or not values or any(isinstance(value, str) for value in values):
        return {}
    if all(isinstance(value, bool) for value in values):
        return {"kind": "output", "values": [False, True]}
    guess = guess_argument(_last_word(command.text), _setting(command, part))
    if guess.table.get("kind") in ("translation", "rotation", "duration"):
        return guess.table
    if 2 <= len(values) <= _MOST_VALUES:
        return {"kind": "output", "values": values}
    if len(values) > _MOST_VALUES:
        return {"kind": "output", "range": [float(min(values)), float(max(values))]}
    return {}


def _read(command: SeenCommand, groups: Sequence[Sequence[Any]]) -> dict[str, Any]:
    part = next((part for part in command.result if part.path == "" and part.always), None)
    if part is None or part.length is not None or not part.values:
        return {}
    if part.type == "bool":
        return {"result": {"kind": "flag"}}
    setting = replace(_setting(command, part), constants=with_compared(part.values, groups))
    guess = guess_reading(_last_word(command.text), setting)
    is_complete = guess.table.get("kind") != "label" or "values" in guess.table
    return {"result": guess.table} if guess.table and is_complete else {}


def _setting(command: SeenCommand, part: Part) -> Setting:
    annotation = "str" if part.type == "str" else ""
    return Setting("_".join(_words(command.text)), "", annotation, part.values)


def _last_word(text: str) -> str:
    """The name at the end of a node's id: ``speed`` of ``ns=2;s=Belt.Speed``."""
    return (_words(text) or [""])[-1]


def _words(text: str) -> Sequence[str]:
    parts = re.split(r"[^A-Za-z0-9]+", re.sub(r"(?<=[a-z])(?=[A-Z])", "_", text))
    return [part.lower() for part in parts if part]


def _seen(command: SeenCommand, reads: bool) -> str:
    parts = command.result if reads else [part for parts in command.arguments.values() for part in parts]
    shown = [str(value) for part in parts for value in part.values]
    return ", ".join(shown[:4]) + (", …" if len(shown) > 4 else "")
