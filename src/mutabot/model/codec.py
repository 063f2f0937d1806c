"""Plain data to JSON-like data and back, by the type hints of the dataclasses."""

from __future__ import annotations

import types
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

T = TypeVar("T")


def to_data(value: Any) -> Any:
    """JSON-like data for a dataclass, enum, container or plain value. Fields equal to None are left out."""
    if is_dataclass(value) and not isinstance(value, type):
        pairs = ((field.name, getattr(value, field.name)) for field in fields(value))
        return {name: to_data(item) for name, item in pairs if item is not None}
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, Mapping):
        return {str(key): to_data(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [to_data(item) for item in value]
    return value


def from_data(kind: type[T], data: Any) -> T:
    """The value of type ``kind`` that ``to_data`` turned into ``data``.

    Raises TypeError for data that does not fit, which can only be a fault of our own.
    """
    result: T = _decode(kind, data)
    return result


@cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _decode(kind: Any, data: Any) -> Any:
    origin = get_origin(kind)
    if kind is Any:
        return data
    if origin in (Union, types.UnionType):
        options = [option for option in get_args(kind) if option is not type(None)]
        return None if data is None else _decode(options[0] if len(options) == 1 else Any, data)
    if origin in (tuple, list):
        return _decode_sequence(origin, get_args(kind), data)
    if origin in (dict, Mapping) or (origin is not None and issubclass(origin, Mapping)):
        item = get_args(kind)[1]
        return {key: _decode(item, value) for key, value in data.items()}
    if isinstance(kind, type) and is_dataclass(kind):
        hints = _hints(kind)
        given = {name: _decode(hints[name], value) for name, value in data.items()}
        return kind(**{**_left_out(kind), **given})
    if isinstance(kind, type) and issubclass(kind, Enum):
        return kind(data)
    return float(data) if kind is float and isinstance(data, int) else data


def _left_out(kind: type[Any]) -> dict[str, None]:
    """Fields without a default: they are missing in the data when they were None."""
    return {
        field.name: None
        for field in fields(kind)
        if field.default is MISSING and field.default_factory is MISSING
    }


def _decode_sequence(origin: Any, arguments: tuple[Any, ...], data: Any) -> Any:
    if origin is tuple and (len(arguments) != 2 or arguments[1] is not Ellipsis):
        return tuple(_decode(kind, item) for kind, item in zip(arguments, data, strict=True))
    return origin(_decode(arguments[0], item) for item in data)
