"""Describes values without importing their types: plain numbers, texts and sequences by path."""

from __future__ import annotations

import dataclasses
import enum
import math
from collections.abc import Iterator, Mapping
from typing import Any

from mutabot_init.observations import Values, WatchedPart

#: different values that are kept of each part, elements of a sequence, parts of a value
MOST_VALUES, MOST_ELEMENTS, MOST_PARTS = 8, 16, 64
_DEPTH, _DEPTH_OF_MESSAGES = 3, 8
_LONGEST = 80
#: largest array that is turned into a list
_LARGEST = 4096
#: parts of an object that is no declared record but may be one
_MOST_FIELDS = 12
#: messages that mean something only as a whole
_WHOLE = frozenset({"geometry_msgs/Quaternion"})
#: properties that are parts of a vector or a pose
_COORDINATES = ("x", "y", "z", "w", "roll", "pitch", "yaw", "theta")
#: what is worth a look in objects of a package written in C
_OF_NATIVE = {"MjData": ("ctrl",)}


def look(values: Values, value: Any, root: str = "", *, message: bool = False) -> None:
    """Add the description of a value; paths in a ``message`` begin with the names of its fields."""
    values.times += 1
    values.type = values.type or type_of(value)
    whole = WatchedPart(root, type=type_of(value) if message else "")
    found = _parts(value, whole, _DEPTH_OF_MESSAGES if message else _DEPTH)
    for _, part in zip(range(MOST_PARTS), found, strict=False):
        if message:
            part.path = part.path.removeprefix(".")
        merge_part(values, part)


def merge_part(values: Values, part: WatchedPart) -> None:
    """Merge a part into what was observed of it before."""
    known = values.parts.get(part.path)
    part.count = part.count or 1
    if known is None:
        values.parts[part.path] = part
        return
    known.count += part.count
    if known.members != part.members:  # not always one of the same enumeration
        known.members = []
    if part.length is not None and known.length is not None:
        known.length = min(part.length, known.length)
    for value in part.values:
        is_new = all(value != other or type(value) is not type(other) for other in known.values)
        if is_new and len(known.values) < MOST_VALUES:
            known.values.append(value)


def type_of(value: Any) -> str:
    """Return ``package/Name`` for a message; the name of the class for anything else."""
    kind = type(value)
    own = getattr(kind, "_type", None)
    if isinstance(own, str) and hasattr(kind, "_slot_types"):
        return own
    if hasattr(kind, "get_fields_and_field_types"):
        return f"{kind.__module__.partition('.')[0]}/{kind.__name__}"
    return kind.__name__


def _parts(value: Any, part: WatchedPart, depth: int) -> Iterator[WatchedPart]:
    value = plain(value)
    declared, part.type = part.type, part.type or type_of(value)
    if value is None:
        return
    value = _in_seconds(value)
    if isinstance(value, enum.Enum) and not isinstance(value, enum.Flag):
        part.members = [*type(value).__members__]
    if isinstance(value, bool | int | float | str):
        part.values = [value[:_LONGEST] if isinstance(value, str) else value] if _is_finite(value) else []
        yield part
    elif isinstance(value, enum.Enum) or depth == 0 or declared in _WHOLE:
        yield part
    elif isinstance(value, list | tuple) and not hasattr(type(value), "_fields"):
        yield from _elements(value, part, depth)
    else:
        yield from _fields(value, part, depth)


def _elements(value: list[Any] | tuple[Any, ...], part: WatchedPart, depth: int) -> Iterator[WatchedPart]:
    if value and _message_fields(value[-1]) is not None:
        yield from _parts(value[-1], dataclasses.replace(part, path=f"{part.path}[-1]", type=""), depth - 1)
        return
    items = [plain(element) for element in value[:MOST_ELEMENTS]]
    if all(isinstance(element, int | float) and not isinstance(element, bool) for element in items):
        part.length = len(value)
        part.values = [items] if items and all(map(_is_finite, items)) else []
        yield part
        return
    for index, item in enumerate(items[:8]):
        yield from _parts(item, WatchedPart(f"{part.path}[{index}]", doc=part.doc), depth - 1)


def _fields(value: Any, part: WatchedPart, depth: int) -> Iterator[WatchedPart]:
    types = _message_fields(value)
    doc = (type(value).__doc__ or "")[:300] if types is None else ""
    empty = True
    for step, name, inner in _named(value, types):
        empty = False
        within = (*part.within, (type_of(value), name)) if types is not None else ()
        kind = types[name] if types is not None else ""
        yield from _parts(inner, WatchedPart(f"{part.path}{step}", name, doc, kind, within), depth - 1)
    if empty:
        yield part


def plain(value: Any) -> Any:
    """Return small arrays and scalars of numeric libraries as Python values."""
    is_array = hasattr(type(value), "tolist") and getattr(value, "size", 0) <= _LARGEST
    return value.tolist() if is_array else value


def _named(value: Any, types: Mapping[str, str] | None) -> Iterator[tuple[str, str, Any]]:
    """Yield step, name and value of the named parts of an object."""
    if isinstance(value, Mapping):
        for key, part in list(value.items())[:MOST_PARTS]:
            if isinstance(key, str) and '"' not in key and "]" not in key:
                yield f'["{key}"]', key, part
        return
    for name in types if types is not None else _names(value):
        if not name.startswith("_") and hasattr(value, name):
            yield f".{name}", name, getattr(value, name)


def _names(value: Any) -> tuple[str, ...]:
    kind = type(value)
    if isinstance(value, type) or callable(value):
        return ()
    if kind.__name__ in _OF_NATIVE:
        return _OF_NATIVE[kind.__name__]
    names: Any = getattr(kind, "_fields", None)  # the type's: a mock has any attribute
    found = tuple(name for name in _COORDINATES if hasattr(kind, name))
    if names is None and found and not dataclasses.is_dataclass(kind):  # a vector written in C
        names = found
    if names is None and (dataclasses.is_dataclass(value) or _is_record(value)):
        names = vars(value) if hasattr(value, "__dict__") else getattr(kind, "__slots__", ())
    return (names,) if isinstance(names, str) else tuple(names or ())


def _is_record(value: Any) -> bool:
    """Return whether an object does little more than contain plain values, as a pose does."""
    parts = vars(value).values() if hasattr(value, "__dict__") else ()
    slots = hasattr(type(value), "__slots__") and not parts
    return slots or (0 < len(parts) <= _MOST_FIELDS and all(map(_is_plain_part, parts)))


def _is_plain_part(part: Any) -> bool:
    part = plain(part)
    if isinstance(part, list | tuple):
        return len(part) <= MOST_ELEMENTS and all(map(_is_plain_part, part))
    return isinstance(part, bool | int | float | str | None | enum.Enum) or dataclasses.is_dataclass(part)


def _message_fields(value: Any) -> Mapping[str, str] | None:
    """Return the types of a message's fields, by name; None if it is not a message."""
    kind = type(value)
    if hasattr(kind, "_slot_types"):
        return dict(zip(kind.__slots__, kind._slot_types, strict=True))
    if hasattr(kind, "get_fields_and_field_types"):
        return dict(kind.get_fields_and_field_types())
    return None


def _in_seconds(value: Any) -> Any:
    """Return a time or duration in a message in seconds; other values unchanged."""
    for whole, rest in (("sec", "nanosec"), ("secs", "nsecs")):
        if hasattr(type(value), whole) and hasattr(value, rest):  # the type's: a mock has any attribute
            return float(getattr(value, whole) + getattr(value, rest) / 1e9)
    return value


def _is_finite(value: Any) -> bool:
    return not isinstance(value, float) or math.isfinite(value)
