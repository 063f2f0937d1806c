"""What one process sees of the names of a middleware: what is done under which, with which messages.

The hooks are those of a campaign (``runtime.targets.messages``); what stands around each use looks at it and
changes nothing.
"""

from __future__ import annotations

import inspect
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from contextvars import ContextVar
from dataclasses import asdict, dataclass, field
from types import FrameType
from typing import Any

from mutabot.model.operation import MAIN, SETTING_UP, WRITTEN, Form
from mutabot.runtime.targets.messages import Messages
from mutabot.runtime.targets.target import Handler, Where
from mutabot.runtime.watching.described import note

#: uses of one name whose messages are looked at; more are only counted
_MOST = 300
_LOOKED_AT = MAIN | {Form.FEEDBACK, Form.RESULT}
#: whether something is done under a name here: only the outermost counts, as in a campaign
_under_way: ContextVar[bool] = ContextVar("mutabot_watched_name", default=False)
#: elements of a sequence that are kept, and parts of a message
_MOST_ELEMENTS, _MOST_PARTS = 16, 64
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
                note(self._found, part)

    def data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "type": self.type,
            "times": self._times,
            "parts": [asdict(part) for part in self._found.values()],
        }


@dataclass
class _Use:
    """What was seen of a form under a name, on one side."""

    form: Form
    name: str
    of_tests: bool
    is_called_back: bool
    sites: dict[tuple[str, int], int] = field(default_factory=dict)
    written: Parts = field(default_factory=Parts)
    read: Parts = field(default_factory=Parts)
    looked_at: int = 0


class NamesSeen(Messages):
    """All that is done under names, where it is the program's or the tests'.

    Args:
        place_of: file for people, line, and whether it is on the tests' side, of a frame or the nearest one
            around it; None if it is nobody's.
        passed: told of each use: calls that are under way lead to it.
        pulse: called now and then, while nothing is held.
    """

    def __init__(
        self,
        place_of: Callable[[FrameType | None, Where | None], tuple[str, int, bool] | None],
        passed: Callable[[], None],
        pulse: Callable[[], None],
    ) -> None:
        self._place_of, self._passed, self._pulse = place_of, passed, pulse
        self._uses: dict[tuple[Form, str, bool, bool], _Use] = {}
        self._lock = threading.RLock()
        super().__init__(lambda target, finding: None)

    def find(self, form: Form, name: str, node: str | None) -> Handler | None:
        """What looks at a use; None where something is set up, which is noted at once."""
        self._passed()
        if form in SETTING_UP and not _under_way.get():
            self._use(form, name, self._place_of(sys._getframe(1), None), False)
        if form not in _LOOKED_AT:
            return None

        def handle(
            wrapped: Callable[..., Any],
            instance: Any,
            args: tuple[Any, ...],
            kwargs: dict[str, Any],
            where: Where | None = None,
        ) -> Any:
            if _under_way.get():
                return wrapped(*args, **kwargs)
            is_called_back = where is not None and where.code is not None
            use = self._use(form, name, self._place_of(sys._getframe(1), where), is_called_back)
            if use is not None and args:
                self._look(use.written, args[0])
            if inspect.iscoroutinefunction(wrapped):
                return self._awaited(use, wrapped(*args, **kwargs))
            token = _under_way.set(True)
            try:
                result = wrapped(*args, **kwargs)
            finally:
                _under_way.reset(token)
            self._answer(use, result)
            return result

        return handle

    def data(self) -> list[dict[str, Any]]:
        """All uses, for JSON."""
        with self._lock:
            return [
                {
                    "form": use.form,
                    "name": use.name,
                    "of_tests": use.of_tests,
                    "is_called_back": use.is_called_back,
                    "sites": [[*site, count] for site, count in use.sites.items()],
                    "written": use.written.data(),
                    "read": use.read.data(),
                }
                for use in self._uses.values()
            ]

    def _use(
        self, form: Form, name: str, place: tuple[str, int, bool] | None, is_called_back: bool
    ) -> _Use | None:
        """The use that a place is one of, if it is to be looked at."""
        if place is None:
            return None
        self._pulse()
        file, line, of_tests = place
        with self._lock:
            key = (form, name, of_tests, is_called_back)
            use = self._uses.setdefault(key, _Use(*key))
            use.sites[file, line] = use.sites.get((file, line), 0) + 1
            use.looked_at += 1
            return use if use.looked_at <= _MOST else None

    async def _awaited(self, use: _Use | None, waiting: Any) -> Any:
        result = await waiting
        self._answer(use, result)
        return result

    def _answer(self, use: _Use | None, result: Any) -> None:
        if use is not None and (use.form not in WRITTEN or use.form is Form.CALL):
            self._look(use.read, result)

    def _look(self, parts: Parts, value: Any) -> None:
        with self._lock, suppress(Exception):  # looking at values must not disturb the program
            parts.see(value)


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
