"""Whether data that a worker sent are what they should be, before anything is made of them.

Workers may be broken, of another version, or hostile. What does not fit is told in words that name the place.
"""

from __future__ import annotations

import json
import math
import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

from mutabot.border.codec import from_data

#: bytes of an answer, levels of lists in it, and the size of counts: none that makes sense comes near
MOST_BYTES, _DEEPEST, _MOST = 64 << 20, 64, 10**15
#: integers in the user's own data; greater ones are no fractions that could be compared
_GREATEST = 2**1023
#: fields that are measured by us, and finite
_MEASURED = {"wall", "cpu"}

T = TypeVar("T")
Check = Callable[[Any], None]


class Misfit(ValueError):  # noqa: N818  # it is a finding
    """Data that are not what they should be."""


def read(data: bytes) -> Any:
    """What stands in bytes of JSON, with texts that can be stored. Raises Misfit."""
    if len(data) > MOST_BYTES:
        raise Misfit(f"{len(data)} bytes, more than {MOST_BYTES}")
    try:
        return _plain(json.loads(data.decode("utf-8")), 0)
    except RecursionError:
        raise Misfit(f"lists deeper than {_DEEPEST} levels") from None
    except UnicodeDecodeError:
        raise Misfit("no text in UTF-8") from None
    except Misfit:
        raise
    except ValueError as error:
        raise Misfit(f"no JSON ({error})"[:200]) from None


def checked(kind: type[T], data: Any) -> T:
    """The value of a type in such data. Raises Misfit."""
    anything: Any = kind
    _check(anything)(data)
    return from_data(kind, data)


def _plain(value: Any, depth: int) -> Any:
    """A value with storable texts: of characters that come in halves only the whole ones."""
    if depth > _DEEPEST:
        raise Misfit(f"lists deeper than {_DEEPEST} levels")
    if isinstance(value, str):
        return value if value.isascii() else value.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(value, list):
        return [_plain(item, depth + 1) for item in value]
    if isinstance(value, dict):
        return {_plain(key, depth): _plain(item, depth + 1) for key, item in value.items()}
    if isinstance(value, int) and abs(value) >= _GREATEST:
        raise Misfit("a number of more than 300 digits")
    return value


@cache
def _check(kind: Any) -> Check:
    """What raises Misfit for data that are not of a type."""
    origin, arguments = get_origin(kind), get_args(kind)
    if kind is Any:
        return lambda data: None
    if origin in (Union, types.UnionType):
        return _check_optional([option for option in arguments if option is not type(None)])
    if origin in (tuple, list):
        return _check_sequence(kind, arguments)
    if origin is not None and issubclass(origin, Mapping):
        return _check_mapping(_check(arguments[1]))
    if is_dataclass(kind):
        return _check_fields(kind)
    if issubclass(kind, Enum):
        return _check_that(lambda data: data in {one.value for one in kind}, kind.__name__)
    return _check_that(*_SIMPLE[kind])


def _is_count(data: Any) -> bool:
    return type(data) is int and abs(data) <= _MOST


_SIMPLE: dict[Any, tuple[Callable[[Any], bool], str]] = {
    str: (lambda data: type(data) is str, "a text"),
    bool: (lambda data: type(data) is bool, "true or false"),
    int: (_is_count, "an integer"),
    float: (lambda data: type(data) is float or _is_count(data), "a number"),
}


def _check_that(holds: Callable[[Any], bool], what: str) -> Check:
    def check(data: Any) -> None:
        if isinstance(data, list | dict) or not holds(data):
            raise Misfit(f"{_shown(data)} is not {what}")

    return check


def _check_optional(options: list[Any]) -> Check:
    item = _check(options[0] if len(options) == 1 else Any)
    return lambda data: None if data is None else item(data)


def _check_sequence(kind: Any, arguments: tuple[Any, ...]) -> Check:
    is_open = get_origin(kind) is list or (len(arguments) == 2 and arguments[1] is Ellipsis)
    items = [_check(arguments[0])] if is_open else [_check(one) for one in arguments]

    def check(data: Any) -> None:
        if not isinstance(data, list) or (not is_open and len(data) != len(items)):
            raise Misfit(f"{_shown(data)} is not a list" + ("" if is_open else f" of {len(items)}"))
        for index, value in enumerate(data):
            _at(f"[{index}]", items[0 if is_open else index], value)

    return check


def _check_mapping(item: Check) -> Check:
    def check(data: Any) -> None:
        if not isinstance(data, dict):
            raise Misfit(f"{_shown(data)} is not an object")
        for key, value in data.items():
            _at(f".{key[:100]}", item, value)

    return check


def _check_fields(kind: Any) -> Check:
    def check(data: Any) -> None:
        if not isinstance(data, dict):
            raise Misfit(f"{_shown(data)} is not an object")
        known, needed = _fields(kind)
        for name in data.keys() - known.keys():
            raise Misfit(f"{kind.__name__} has no field {_shown(name)}")
        for name in needed - data.keys():
            raise Misfit(f"{kind.__name__} lacks {name}")
        for name, value in data.items():
            _at(f".{name}", known[name], value)
            if name in _MEASURED and not 0 <= value < math.inf:
                raise Misfit(f".{name}: {value} is no time")

    return check


@cache
def _fields(kind: Any) -> tuple[dict[str, Check], set[str]]:
    """How each field is checked, and which must be there: what is None is left out."""
    hints = get_type_hints(kind)
    needed = {
        field.name
        for field in fields(kind)
        if field.default is MISSING
        and field.default_factory is MISSING
        and hints[field.name] is not Any
        and type(None) not in get_args(hints[field.name])
    }
    return {name: _check(hint) for name, hint in hints.items()}, needed


def _at(place: str, check: Check, value: Any) -> None:
    try:
        check(value)
    except Misfit as error:
        text = str(error)
        raise Misfit(place + (text if text[:1] in (".", "[") else f": {text}")) from None


def _shown(data: Any) -> str:
    """A value in a message, whatever its size."""
    if isinstance(data, str):
        return repr(data[:60])
    return f"a {type(data).__name__}" if isinstance(data, list | dict) else repr(data)[:60]
