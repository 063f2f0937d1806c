"""Recordings: positions of tool and objects over time, contacts, commands and readings.

Plain data, made in the robot program's process and read outside of it. The standard library is enough.
"""

from __future__ import annotations

import base64
import json
import zlib
from array import array
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import lru_cache
from typing import Any, NamedTuple

#: single precision: a position of some metres to a micrometre
_TYPE = "f"


class TrackKind(StrEnum):
    """The meaning of a track's numbers."""

    POSE = "pose"
    POINT = "point"
    VALUE = "value"
    LINE = "line"

    @property
    def width(self) -> int:
        """The count of numbers per moment: x, y, z in m, for a pose followed by the quaternion w, x, y, z.

        Of a line those of each of its points.
        """
        return {TrackKind.POSE: 7, TrackKind.POINT: 3, TrackKind.VALUE: 1, TrackKind.LINE: 3}[self]


@dataclass(slots=True)
class Track:
    """The values of a thing over time.

    Attributes:
        name: what it is, such as ``tool``.
        kind: what the numbers are.
        values: ``width`` numbers per moment, one moment after the other; NaN where it was not there.
        unit: of a value; positions are in m, in the world's frame.
        size: edge lengths of its box in m, of an object that has one; to draw it and to see how near it was.
        radii: of a line, how thick it is at each of its points, m. A line is drawn, and never compared.
    """

    name: str
    kind: TrackKind
    values: array[float]
    unit: str = ""
    size: tuple[float, float, float] | None = None
    radii: tuple[float, ...] = ()

    @property
    def width(self) -> int:
        """The count of numbers at each moment."""
        return self.kind.width * max(1, len(self.radii))


class Block(NamedTuple):
    """A box that never moves: a table, a conveyor, a wall. In m, world frame, edges along the axes.

    Attributes:
        name: what it is.
        centre: its middle.
        size: edge lengths.
        colour: red, green, blue, opacity from 0 to 1; None for no wish.
    """

    name: str
    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    colour: tuple[float, ...] | None = None


class RecordedMoment(NamedTuple):
    """An event.

    Attributes:
        time: s.
        what: ``touch`` and ``part`` of two bodies, or ``note``.
        text: which bodies (``box, table``), or the simulator's own words.
    """

    time: float
    what: str
    text: str


class RecordedCall(NamedTuple):
    """A call of an operation.

    Attributes:
        began, ended: s; None without a clock.
        operation: its name in the vocabulary.
        place: ``file:line`` of the call.
        pattern: which text command it was, or None.
        written, read: values by quantity.
        role: ``program`` or ``oracle``.
    """

    began: float | None
    ended: float | None
    operation: str
    place: str
    pattern: str | None
    written: Mapping[str, Any]
    read: Mapping[str, Any]
    role: str = "program"


@dataclass(slots=True)
class Recording:
    """The recording of one test.

    Attributes:
        times: moments at which the tracks were read, s since the test's first simulated moment.
        tracks: by name.
        blocks: what stands around.
        moments: what happened, in its order.
        calls: operations, in their order.
        fault: when the mutant changed something for the first time, s; None if it did not, or without a
            clock.
        faulty_call: how many calls had been made by then; None if it did not.
        is_simulated: whether the times are simulated; else they are of the wall clock.
        problems: what could not be read, one line each.
        robots: names of bodies among the contacts that are parts of robots; empty if that is not known.
    """

    times: array[float] = field(default_factory=lambda: array("d"))
    tracks: dict[str, Track] = field(default_factory=dict)
    blocks: tuple[Block, ...] = ()
    moments: list[RecordedMoment] = field(default_factory=list)
    calls: list[RecordedCall] = field(default_factory=list)
    fault: float | None = None
    faulty_call: int | None = None
    is_simulated: bool = True
    problems: list[str] = field(default_factory=list)
    robots: tuple[str, ...] = ()


#: the fields of a recording that are kept as JSON, as they are
_PLAIN_FIELDS = (
    "blocks", "moments", "calls", "fault", "faulty_call", "is_simulated", "problems", "robots",
)  # fmt: skip


def to_bytes(recording: Recording) -> bytes:
    """Return the recording as compressed bytes, to be stored; numbers are in this machine's byte order."""
    tracks = recording.tracks.values()
    fields = {name: getattr(recording, name) for name in _PLAIN_FIELDS}
    fields["tracks"] = [(track.name, track.kind, track.unit, track.size, track.radii) for track in tracks]
    fields["count"] = len(recording.times)
    head = json.dumps(fields, default=_plain, separators=(",", ":")).encode()
    numbers = [values.tobytes() for values in (recording.times, *(track.values for track in tracks))]
    return _compressed(b"".join([len(head).to_bytes(4, "little"), head, *numbers]))


@lru_cache(1)
def _compressed(data: bytes) -> bytes:
    """Compress data, and cache the result for an equal recording, such as of tests without commands."""
    return zlib.compress(data, 1)


def from_bytes(data: bytes) -> Recording:
    """Read a recording from the bytes of ``to_bytes``. Raises ValueError for anything else."""
    try:
        data = zlib.decompress(data)
        end = 4 + int.from_bytes(data[:4], "little")
        head = json.loads(data[4:end])
        count = head["count"]
        times, end = _numbers("d", data, end, count)
        tracks = {}
        for name, kind, unit, size, *radii in head["tracks"]:  # earlier versions know no radii
            track = Track(name, TrackKind(kind), array(_TYPE), unit, _tuple(size), *map(tuple, radii))
            track.values, end = _numbers(_TYPE, data, end, count * track.width)
            tracks[name] = track
        head.setdefault("robots", ())  # recordings of earlier versions do not say
        fields = {name: head[name] for name in _PLAIN_FIELDS}
        fields["robots"] = tuple(fields["robots"])
        fields["blocks"] = tuple(Block(block[0], *map(_tuple, block[1:])) for block in fields["blocks"])
        fields["moments"] = [RecordedMoment(*fields_of_moment) for fields_of_moment in fields["moments"]]
        fields["calls"] = [RecordedCall(*fields_of_call) for fields_of_call in fields["calls"]]
        return Recording(times, tracks, **fields)
    except (zlib.error, LookupError, TypeError) as error:
        raise ValueError(f"no recording: {error}") from error


def to_text(recording: Recording) -> str:
    """Return the recording as a line of ASCII, for the pipe to the controller."""
    return base64.b64encode(to_bytes(recording)).decode()


def bytes_of(text: str) -> bytes:
    """Return the bytes, as ``to_bytes`` made them, of a text of ``to_text``."""
    return base64.b64decode(text)


def _numbers(kind: str, data: bytes, start: int, count: int) -> tuple[array[float], int]:
    """Read a count of numbers from an offset; return them and the offset behind them."""
    numbers: array[float] = array(kind)
    end = start + count * numbers.itemsize
    numbers.frombytes(data[start:end])
    return numbers, end


def _tuple(numbers: Any) -> Any:
    return None if numbers is None else tuple(numbers)


def _plain(value: Any) -> Any:
    """Convert a value that JSON does not support."""
    return value.tolist() if hasattr(type(value), "tolist") else repr(value)
