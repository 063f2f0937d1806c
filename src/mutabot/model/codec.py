"""Turn dataclasses into JSON-like data and back, by their type hints.

Written by hand because every process beside a robot program imports it: 0.1 ms, where msgspec takes 10 ms and
cattrs 22 ms.

What leaves a process is data that every reader can take, whatever the user's objects hold: texts become UTF-8
without surrogates, and endless texts, numbers and nesting are cut. Data that is fine passes unchanged.
"""

from __future__ import annotations

import re
import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from json import dumps
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

from mutabot.model.source_units import digest

T = TypeVar("T")
Decoder = Callable[[Any], Any]
#: scalar types of JSON, which are passed on unchanged
_PLAIN = frozenset({str, int, float, bool, type(None)})


def is_plain(value: Any) -> bool:
    """Return whether a value is of a scalar type of JSON: None, a truth value, a number or a text."""
    return type(value) in _PLAIN


def to_data(value: Any) -> Any:
    """Convert a dataclass, enum, container or plain value to JSON-like data. None fields are left out."""
    kind: Any = type(value)
    if kind in _PLAIN:
        return value
    names = _names(kind)
    if names is not None:
        return {name: to_data(item) for name in names if (item := getattr(value, name)) is not None}
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, Mapping):
        return {str(key): to_data(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [to_data(item) for item in value]
    return value


def shallow(value: Any) -> dict[str, Any]:
    """Return the fields of a dataclass that are not None, with their values unchanged."""
    kind: Any = type(value)
    names = _names(kind) or ()
    return {name: item for name in names if (item := getattr(value, name)) is not None}


def sparse(value: Any) -> dict[str, Any]:
    """Return the fields of a dataclass that are neither None nor equal to their defaults."""
    found = {}
    kind: Any = type(value)
    for name, default, is_made in _defaults(kind):
        item = getattr(value, name)
        if item is not None and item is not default and not (is_made and item == default):
            found[name] = item
    return found


@cache
def _defaults(kind: type[Any]) -> tuple[tuple[str, Any, bool], ...]:
    """Return the fields of a dataclass with their defaults, and whether each default is made by a factory."""
    return tuple(
        (field.name, field.default, False)
        if field.default_factory is MISSING
        else (field.name, field.default_factory(), True)
        for field in fields(kind)
    )


@cache
def _names(kind: type[Any]) -> tuple[str, ...] | None:
    """Return the fields of a dataclass; None for any other type."""
    return tuple(field.name for field in fields(kind)) if is_dataclass(kind) else None


def from_data(kind: type[T], data: Any) -> T:
    """Return the value of type ``kind`` that ``to_data`` turned into ``data``.

    Raises TypeError, ValueError, KeyError or OverflowError for data that does not fit: what another process
    says may be anything.
    """
    anything: Any = kind
    result: T = _decoder(anything)(data)
    return result


@cache
def _decoder(kind: Any) -> Decoder:
    """Return a function that decodes values of a type; cached, as there are many lines to decode."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType):
        options = [option for option in arguments if option is not type(None)]
        inner = _decoder(options[0] if len(options) == 1 else Any)
        return lambda data: None if data is None else inner(data)
    if origin in (tuple, list):
        return _sequence_decoder(origin, arguments)
    if origin is not None and issubclass(origin, Mapping):
        item = _decoder(arguments[1])
        return lambda data: {key: item(value) for key, value in _checked(data, (dict,), "an object").items()}
    if isinstance(kind, type) and is_dataclass(kind):
        return _dataclass_decoder(kind)
    if isinstance(kind, type) and issubclass(kind, Enum):
        return kind
    return _PLAIN_DECODERS.get(kind, _as_it_is)


def _as_it_is(data: Any) -> Any:
    return data


def _checked(data: Any, kinds: tuple[type[Any], ...], wanted: str) -> Any:
    if type(data) in kinds:
        return data
    raise TypeError(f"{wanted} was expected, not {type(data).__name__}")


#: JSON writes a number without a fraction as a whole one
_PLAIN_DECODERS: dict[Any, Decoder] = {
    str: lambda data: _checked(data, (str,), "a text"),
    bool: lambda data: _checked(data, (bool,), "true or false"),
    int: lambda data: _checked(data, (int,), "a whole number"),
    float: lambda data: float(_checked(data, (float, int), "a number")),
}


def _sequence_decoder(origin: Any, arguments: tuple[Any, ...]) -> Decoder:
    if origin is tuple and (len(arguments) != 2 or arguments[1] is not Ellipsis):
        items = [_decoder(kind) for kind in arguments]
        return lambda data: tuple(decode(value) for decode, value in zip(items, _list(data), strict=True))
    item = _decoder(arguments[0])
    if item is _as_it_is:
        return lambda data: origin(_list(data))
    return lambda data: origin(map(item, _list(data)))


def _list(data: Any) -> Any:
    return _checked(data, (list, tuple), "a list")


def _dataclass_decoder(kind: Any) -> Decoder:
    def decode(data: Any) -> Any:
        decoders, left_out = _fields(kind)  # not before now: a class may refer to itself
        items = _checked(data, (dict,), "an object").items()
        return kind(**dict.fromkeys(left_out) | {name: decoders[name](value) for name, value in items})

    return decode


@cache
def _fields(kind: type[Any]) -> tuple[dict[str, Decoder], tuple[str, ...]]:
    """Return the decoders of all fields, and the names of those without a default that may be None."""
    hints = get_type_hints(kind)
    decoders = {name: _decoder(hint) for name, hint in hints.items()}
    left_out = tuple(
        field.name
        for field in fields(kind)
        if field.default is MISSING
        and field.default_factory is MISSING
        and (hints[field.name] is Any or type(None) in get_args(hints[field.name]))
    )
    return decoders, left_out


#: the field whose text mutabot itself makes: of no use if it is cut
_WHOLE = "recording"
#: characters of a text, binary digits of a whole number (Python writes 4,300 decimal ones at most), and
#: levels of nesting that are kept
MOST_CHARACTERS, MOST_BITS, MOST_DEPTH = 1 << 18, 14_000, 60
_TEXTS = re.compile(rb'"(?:[^"\\]|\\.)*"')
_NO_BRACKETS = bytes(set(range(256)).difference(b"[]{}"))
#: how JSON in ASCII writes what may be half of a character
_SURROGATE = "\\ud"


def data_digest(data: Any) -> str:
    """Return the digest of JSON-like data; anything else counts by its text."""
    text = dumps(data, sort_keys=True, default=str)
    return digest(text.encode())


def printable(text: str) -> str:
    """Return a text with lone surrogates written as ``\udcff``; any other text is returned unchanged."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return text.encode("utf-8", "backslashreplace").decode()
    return text


def to_json(value: Any, default: Callable[[Any], Any]) -> bytes:
    """Return a value as ASCII JSON that any reader can parse; fields equal to their defaults are left out.

    ``default`` gives data for what neither JSON nor ``to_data`` knows.
    """

    def known(item: Any) -> Any:
        kind: Any = type(item)
        if _names(kind) is not None:
            return sparse(item)
        if issubclass(kind, Enum):
            return item.value
        return dict(item) if issubclass(kind, Mapping) else default(item)

    try:
        text = dumps(value, default=known, separators=(",", ":"))
        if _is_fine(text):
            return text.encode()
    except (ValueError, TypeError, RecursionError, OverflowError):
        pass  # numbers of thousands of digits, objects that hold themselves, keys that are no texts
    return dumps(storable(value, default), separators=(",", ":")).encode()


def is_too_deep(text: bytes) -> bool:
    """Return whether JSON is nested deeper than anything that ``to_json`` writes."""
    if text.count(b"[") + text.count(b"{") <= MOST_DEPTH:
        return False
    # to leave texts out takes long, and brackets in texts are rare
    return not _is_closed(text) and not _is_closed(_TEXTS.sub(b"", text))


def _is_closed(text: bytes) -> bool:
    """Return whether all brackets close each other, within the permitted depth."""
    brackets = text.translate(None, _NO_BRACKETS)
    for _ in range(MOST_DEPTH + 1):
        if not brackets:
            return True
        brackets = brackets.replace(b"[]", b"").replace(b"{}", b"")
    return not brackets


def _is_fine(text: str) -> bool:
    """Return whether a text is certainly valid JSON, so that the slow check is not needed."""
    is_short = len(text) <= MOST_CHARACTERS or f'"{_WHOLE}"' in text
    return is_short and _SURROGATE not in text and not is_too_deep(text.encode())


def storable(value: Any, default: Callable[[Any], Any] = repr, depth: int = 0) -> Any:
    """Return JSON-like data of a value, with endless structures cut, and with ``printable`` texts."""
    kind = type(value)
    if value is None or kind is bool or kind is float:
        return value
    if isinstance(value, str):
        return _text(str(value.value if isinstance(value, Enum) else value))
    if isinstance(value, Enum):
        return storable(value.value, default, depth)
    if isinstance(value, int):
        return int(value) if value.bit_length() <= MOST_BITS else _text(f"{int(value):#x}")
    if isinstance(value, float):
        return float(value)
    if depth >= MOST_DEPTH:
        return "… (nested more deeply than mutabot looks)"
    if is_dataclass(kind):
        value = shallow(value)
    if isinstance(value, Mapping):
        return _mapping(value, default, depth + 1)
    if isinstance(value, tuple | list):
        return [storable(item, default, depth + 1) for item in value]
    return storable(default(value), default, depth + 1)


def _mapping(value: Mapping[Any, Any], default: Callable[[Any], Any], depth: int) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, item in value.items():
        name = _text(str(key.value) if isinstance(key, Enum) else str(key))
        while name in found:  # what differed still does
            name += "'"
        is_whole = name == _WHOLE and isinstance(item, str)
        found[name] = printable(item) if is_whole else storable(item, default, depth)
    return found


def _text(text: str) -> str:
    if len(text) > MOST_CHARACTERS:
        text = f"{text[:MOST_CHARACTERS]}… (cut: it has {len(text)} characters)"
    return printable(text)
