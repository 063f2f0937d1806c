"""Plain data to JSON-like data and back, by the type hints of the dataclasses.

By hand, since every process beside a robot program would pay for more: beyond the standard library it takes
0.1 ms to import, msgspec 10 ms and cattrs 22 ms, and both ask for the fields that are left out when None.
"""

from __future__ import annotations

import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

T = TypeVar("T")
Decoder = Callable[[Any], Any]
#: what needs no look at what it is
_PLAIN = {str, int, float, bool, type(None)}


def to_data(value: Any) -> Any:
    """JSON-like data for a dataclass, enum, container or plain value. Fields equal to None are left out."""
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


@cache
def _names(kind: type[Any]) -> tuple[str, ...] | None:
    """The fields of a dataclass; None for any other type."""
    return tuple(field.name for field in fields(kind)) if is_dataclass(kind) else None


def from_data(kind: type[T], data: Any) -> T:
    """The value of type ``kind`` that ``to_data`` turned into ``data``.

    Raises TypeError for data that does not fit, which can only be a fault of our own.
    """
    anything: Any = kind
    result: T = _decoder(anything)(data)
    return result


@cache
def _decoder(kind: Any) -> Decoder:
    """What turns data into a value of a type. Made once for each: lines come by the hundred thousand."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType):
        options = [option for option in arguments if option is not type(None)]
        return _optional(_decoder(options[0] if len(options) == 1 else Any))
    if origin in (tuple, list):
        return _sequence_decoder(origin, arguments)
    if origin is not None and issubclass(origin, Mapping):
        item = _decoder(arguments[1])
        return lambda data: {key: item(value) for key, value in data.items()}
    if isinstance(kind, type) and is_dataclass(kind):
        return _dataclass_decoder(kind)
    if isinstance(kind, type) and issubclass(kind, Enum):
        return kind
    return _float if kind is float else _as_it_is


def _as_it_is(data: Any) -> Any:
    return data


def _float(data: Any) -> Any:
    return float(data) if isinstance(data, int) else data


def _optional(decode: Decoder) -> Decoder:
    return lambda data: None if data is None else decode(data)


def _sequence_decoder(origin: Any, arguments: tuple[Any, ...]) -> Decoder:
    if origin is tuple and (len(arguments) != 2 or arguments[1] is not Ellipsis):
        items = [_decoder(kind) for kind in arguments]
        return lambda data: tuple(decode(value) for decode, value in zip(items, data, strict=True))
    item = _decoder(arguments[0])
    return origin if item is _as_it_is else lambda data: origin(map(item, data))


def _dataclass_decoder(kind: Any) -> Decoder:
    def decode(data: Any) -> Any:
        decoders, values = _fields(kind)  # not before now: a class may refer to itself
        values = dict(values)
        for name, value in data.items():
            values[name] = decoders[name](value)
        return kind(**values)

    return decode


@cache
def _fields(kind: type[Any]) -> tuple[dict[str, Decoder], dict[str, None]]:
    """The decoders of all fields, and those without a default: they are missing when they were None."""
    decoders = {name: _decoder(hint) for name, hint in get_type_hints(kind).items()}
    left_out = {
        field.name: None
        for field in fields(kind)
        if field.default is MISSING and field.default_factory is MISSING
    }
    return decoders, left_out
