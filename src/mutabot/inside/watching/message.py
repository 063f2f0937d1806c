"""What was seen of messages, in words that need no import: their parts, with the types that hold them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

#: different values that are kept of each part, elements of a sequence, and parts of a message
_MOST_VALUES, _MOST_ELEMENTS, _MOST_PARTS = 8, 16, 64
_LONGEST = 80
_DEPTH = 8
#: how the two generations of ROS call whole seconds and the rest
_MOMENTS = (("secs", "nsecs"), ("sec", "nanosec"))
_NANO = 1e-9
#: types that mean something only as a whole
_WHOLE = frozenset({"geometry_msgs/Quaternion"})


@dataclass
class Part:
    """A part of a message.

    Attributes:
        path: where it lies, as vocabularies write it; empty for the whole.
        within: the types that hold it, each with the name of its field, the outermost first.
        type: its own type, as the definition says.
        values: the first different values; moments as seconds, sequences of numbers as lists.
        length: number of elements of a sequence, the least that was seen; None for anything else.
        count: in how many messages it was there.
    """

    path: str
    within: list[tuple[str, str]]
    type: str
    values: list[Any] = field(default_factory=list)
    length: int | None = None
    count: int = 0


class Parts:
    """The parts of all messages that passed under a name."""

    def __init__(self) -> None:
        self.type = ""
        self._times = 0
        self._found: dict[str, Part] = {}

    def see(self, value: Any) -> None:
        """One more message, or plain value."""
        self._times += 1
        self.type = self.type or type_of(value)
        for number, part in enumerate(_parts(value, Part("", [], type_of(value)), _DEPTH)):
            if number < _MOST_PARTS:
                self._add(part)

    def data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "type": self.type,
            "times": self._times,
            "parts": [asdict(part) for part in self._found.values()],
        }

    def _add(self, part: Part) -> None:
        known = self._found.setdefault(part.path, part)
        known.count += 1
        if part.length is not None and known.length is not None:
            known.length = min(part.length, known.length)
        for one in part.values:
            is_new = all(one != other or type(one) is not type(other) for other in known.values)
            if is_new and len(known.values) < _MOST_VALUES:
                known.values.append(one)


def type_of(value: Any) -> str:
    """``package/Name`` of a message; the name of the class of anything else."""
    own = getattr(type(value), "_type", None)
    if isinstance(own, str) and hasattr(type(value), "_slot_types"):
        return own
    if hasattr(type(value), "get_fields_and_field_types"):
        return f"{type(value).__module__.partition('.')[0]}/{type(value).__name__}"
    return type(value).__name__


def _parts(value: Any, part: Part, depth: int) -> Iterator[Part]:
    seconds = _seconds(value)
    fields = _fields_of(value) if seconds is None else None
    if seconds is not None:
        part.values = [seconds]
        yield part
    elif fields is None:
        yield from _plain(value, part, depth)
    elif part.type in _WHOLE:
        yield part
    elif depth:
        for name, kind in fields.items():
            within = [*part.within, (type_of(value), name)]
            inner = Part(f"{part.path}.{name}" if part.path else name, within, kind)
            yield from _parts(getattr(value, name), inner, depth - 1)


def _plain(value: Any, part: Part, depth: int) -> Iterator[Part]:
    if hasattr(type(value), "tolist"):  # arrays, and scalars of numeric libraries
        value = value.tolist()
    if isinstance(value, bool | int | float | str):
        part.values = [value[:_LONGEST] if isinstance(value, str) else value]
        yield part
    elif isinstance(value, list | tuple) and value and _fields_of(value[-1]) is not None:
        last = value[-1]
        yield from _parts(last, Part(f"{part.path}[-1]", part.within, type_of(last)), depth - 1)
    elif isinstance(value, list | tuple):
        if all(isinstance(one, int | float) and not isinstance(one, bool) for one in value):
            part.length, part.values = len(value), [list(value[:_MOST_ELEMENTS])] if value else []
        yield part
    elif value is not None:
        yield part


def _fields_of(value: Any) -> Mapping[str, str] | None:
    """The types of the fields of a message, by name; None for what is no message."""
    kind = type(value)
    if hasattr(kind, "_slot_types"):
        return dict(zip(kind.__slots__, kind._slot_types, strict=True))
    if hasattr(kind, "get_fields_and_field_types"):
        fields: Mapping[str, str] = kind.get_fields_and_field_types()
        return fields
    return None


def _seconds(value: Any) -> float | None:
    """A moment or a span of time, in seconds; None for anything else."""
    for whole, rest in _MOMENTS:
        if hasattr(value, whole) and hasattr(value, rest):
            return float(getattr(value, whole) + getattr(value, rest) * _NANO)
    return None
