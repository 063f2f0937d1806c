"""Notations of text commands, for reading values from a command and writing a command with new ones.

A notation is written like a format string: ``lift/{height:g}``. Literal text must match exactly; each
field takes what its type allows. A changed number keeps the look of the one it replaces: decimals,
explicit plus sign and zero padding, as far as the new value can be written that way.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from mutabot.frozen import frozen

_NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_INTEGER = r"[-+]?[0-9]+"
_WORD = r".+?"
_DECIMALS = re.compile(r"(?P<plus>\+?)-?(?P<whole>\d*)(?:(?P<point>\.)(?P<decimals>\d*))?")


@frozen
class Field:
    """One field of a notation: its name and its format specification (may be empty)."""

    name: str
    spec: str

    @property
    def kind(self) -> str:
        """``d`` for whole numbers, ``g`` for any number, ``s`` for text."""
        last = self.spec[-1:]
        if last == "d":
            return "d"
        return "g" if last in ("g", "f", "e", "G", "F", "E") else "s"

    @property
    def expression(self) -> str:
        """Regular expression of the field."""
        return {"d": _INTEGER, "g": _NUMBER, "s": _WORD}[self.kind]


@frozen
class Notation:
    """A compiled notation.

    Example: ``Notation.compile("lift/{height:g}").read("lift/5")`` is ``{"height": 5}``, and
    ``.write({"height": -5}, like="lift/5.00")`` is ``"lift/-5.00"``.
    """

    text: str
    parts: tuple[str | Field, ...]

    @classmethod
    def compile(cls, text: str) -> Notation:
        """Read a notation. Raises ValueError for broken braces, unnamed, repeated or unknown fields."""
        return _compile(text)

    @property
    def fields(self) -> tuple[Field, ...]:
        """The fields in order."""
        return tuple(part for part in self.parts if isinstance(part, Field))

    @property
    def short(self) -> str:
        """The notation without format specifications."""
        return "".join(part if isinstance(part, str) else f"{{{part.name}}}" for part in self.parts)

    def read(self, message: str) -> dict[str, Any] | None:
        """Return the fields' values if the message is this command, else None."""
        match = _expression(self).fullmatch(message)
        if match is None:
            return None
        return {field.name: _value(field, match[field.name]) for field in self.fields}

    def looks(self, message: str) -> dict[str, str]:
        """Return the fields as the message writes them; empty if the message is another command."""
        match = _expression(self).fullmatch(message)
        return match.groupdict() if match is not None else {}

    def write(
        self, values: Mapping[str, Any], *, like: str | None = None, looks: Mapping[str, str] | None = None
    ) -> str:
        """Return the command with these values.

        ``like`` is a message of this notation whose look is kept; ``looks`` gives the looks of the fields
        where they come from a message of another notation, such as the opposite one.
        """
        looks = looks if looks is not None else self.looks(like) if like is not None else {}
        return "".join(
            part if isinstance(part, str) else _print(part, values[part.name], looks.get(part.name))
            for part in self.parts
        )


@lru_cache(maxsize=1024)
def _compile(text: str) -> Notation:
    from string import Formatter  # noqa: PLC0415  # most processes below the tests have no commands

    parts: list[str | Field] = []
    names: set[str] = set()
    for literal, name, spec, conversion in Formatter().parse(text):
        if literal:
            parts.append(literal)
        if name is None:
            continue
        if not name.isidentifier():
            raise ValueError(f"notation {text!r}: a field needs a plain name, not {name!r}")
        if name in names:
            raise ValueError(f"notation {text!r} has two fields named {name!r}")
        if conversion:
            raise ValueError(f"notation {text!r}: a conversion (!{conversion}) cannot be read back")
        names.add(name)
        parts.append(_field(text, name, spec or ""))
    if not parts:
        raise ValueError("a notation cannot be empty")
    return Notation(text, tuple(parts))


def _field(text: str, name: str, spec: str) -> Field:
    field = Field(name, spec)
    try:
        samples = [
            format(sample, spec) for sample in {"d": (1, 12345), "g": (1.0, 12345.0), "s": ("a",)}[field.kind]
        ]
    except ValueError as error:
        raise ValueError(f"notation {text!r}: {{{name}:{spec}}} is not a format ({error})") from None
    if field.kind != "s" and not all(re.fullmatch(field.expression, sample) for sample in samples):
        raise ValueError(
            f"notation {text!r}: {samples[-1]!r}, as {{{name}:{spec}}} prints it, cannot be read back"
        )
    return field


@lru_cache(maxsize=1024)
def _expression(notation: Notation) -> re.Pattern[str]:
    return re.compile(
        "".join(
            re.escape(part) if isinstance(part, str) else f"(?P<{part.name}>{part.expression})"
            for part in notation.parts
        )
    )


def _value(field: Field, text: str) -> Any:
    if field.kind == "d" or (field.kind == "g" and re.fullmatch(_INTEGER, text)):
        return int(text)
    return float(text) if field.kind == "g" else text


def _print(field: Field, value: Any, like: str | None) -> str:
    if like is not None and _value(field, like) == value:
        return like
    if field.kind == "s":
        return format(str(value), field.spec)
    if field.kind == "d":
        value = round(value)
    # "g" alone keeps six digits; that would change a value such as 1234.5678 that is not mutated
    plain = format(value, field.spec) if field.spec != "g" else _shortest(value)
    return _alike(plain, value, like) if like is not None else plain


def _shortest(value: float) -> str:
    number = float(value)
    return str(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)


def _alike(plain: str, value: float, like: str) -> str:
    look = _DECIMALS.fullmatch(like)
    if look is None:
        return plain
    sign = "+" if look["plus"] else "-"
    width = len(look["whole"]) if look["whole"].startswith("0") and len(look["whole"]) > 1 else 0
    decimals = len(look["decimals"] or "")
    if look["point"] or width:
        width += (decimals + 1 if decimals else 0) + (1 if value < 0 or look["plus"] else 0) if width else 0
        padded = f"{value:{sign}{f'0{width}' if width else ''}.{decimals}f}"
        padded += "." if look["point"] and not decimals else ""
        if abs(float(padded) - value) <= 1e-12 * max(1.0, abs(value)):
            return padded
    return f"+{plain}" if look["plus"] and value >= 0 and not plain.startswith("+") else plain
