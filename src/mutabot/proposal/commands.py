"""Text commands: patterns from the texts that a program sends."""

from __future__ import annotations

import re
from collections.abc import Sequence

from .guess import Guess

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
