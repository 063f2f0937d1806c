"""Recordings for Foxglove and whatever else reads MCAP. Needs foxglove-sdk: ``mutabot[mcap]``.

Foxglove's own library rather than a bare MCAP writer: it brings the schemas that its panels know.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mutabot.evidence.recording import Block, Kind
from mutabot.evidence.tracks import Path as Way
from mutabot.evidence.tracks import paths_of

from .events import Weight, events
from .shown import Shown
from .target import check, missing, written_whole

if TYPE_CHECKING:
    from foxglove import messages

_MAGIC = b"\x89MCAP0\r\n"
_WORLD = "world"
_COLOURS = {"original": (0.34, 0.71, 0.91, 1.0), "mutant": (0.90, 0.62, 0.0, 1.0)}
_BLOCK = (0.59, 0.61, 0.64, 0.4)
#: m
_LINE, _DOT = 0.006, 0.024


class Mcap:
    """A file of MCAP. Raises UsageError if it cannot be written."""

    def __init__(self, file: Path) -> None:
        self._file = file
        check(file, "recording", ".mcap", _MAGIC)
        try:
            import foxglove  # noqa: F401, PLC0415  # an extra
        except ImportError as error:
            raise missing("foxglove-sdk", "--mcap", "mcap") from error

    def show(self, shown: Shown) -> str:
        """See ``Sight``."""
        with written_whole(self._file) as part:
            write_mcap(part, shown)
        return f"{self._file}: {self._file.stat().st_size / 1e3:.0f} kB for Foxglove"


def write_mcap(file: Path, shown: Shown) -> None:
    """Write what is recorded; the times are those of the clock of the recording, from 0 on."""
    import foxglove  # noqa: PLC0415  # as above

    context = foxglove.Context()
    file.unlink(missing_ok=True)
    with foxglove.open_mcap(str(file), context=context) as writer:
        writer.write_metadata("mutabot", _about(shown))
        _Topics(shown, context).log()


class _Topics:
    """All topics of a file."""

    def __init__(self, shown: Shown, context: Any) -> None:
        self._shown, self._context = shown, context

    def log(self) -> None:
        """In the order of their times, as readers like it best."""
        found = [line for side, _ in self._shown.sides for line in self._lines(side)]
        for time, channel, message in [*self._scene(), *sorted(found, key=lambda line: line[0])]:
            channel.log(message, log_time=round(time * 1e9))

    def _scene(self) -> Iterator[tuple[float, Any, Any]]:
        """What stands around, and the paths: there from the beginning."""
        from foxglove.channels import SceneUpdateChannel  # noqa: PLC0415  # as above
        from foxglove.messages import SceneUpdate  # noqa: PLC0415  # as above

        blocks = dict.fromkeys(block for _, found in self._shown.sides for block in found.blocks)
        entities = [_block(one) for one in blocks]
        yield 0.0, SceneUpdateChannel("/blocks", context=self._context), SceneUpdate(entities=entities)
        for side, recording in self._shown.sides:
            ways = _things(paths_of(recording))
            entities = [_path(name, way, _COLOURS[side]) for name, way in ways]
            channel = SceneUpdateChannel(f"/{side}/paths", context=self._context)
            yield 0.0, channel, SceneUpdate(entities=entities)

    def _lines(self, side: str) -> Iterator[tuple[float, Any, Any]]:
        recording = dict(self._shown.sides)[side]
        ways = paths_of(recording)
        for name, way in _things(ways):
            yield from self._poses(side, name, way)
        for name, way in ways.items():
            if way.track.kind is Kind.VALUE:
                yield from self._values(side, name, way)
        yield from self._events(side)

    def _poses(self, side: str, name: str, way: Way) -> Iterator[tuple[float, Any, Any]]:
        """Each thing is a frame of its own, in which its shape is at rest."""
        from foxglove import channels, messages  # noqa: PLC0415  # as above

        frame = f"{side}/{name}"
        shapes = channels.SceneUpdateChannel(_topic(side, name, "shape"), context=self._context)
        yield 0.0, shapes, messages.SceneUpdate(entities=[_shape(frame, way, _COLOURS[side])])
        poses = channels.PoseInFrameChannel(_topic(side, name, "pose"), context=self._context)
        frames = channels.FrameTransformChannel(_topic(side, name, "frame"), context=self._context)
        for time, row in zip(way.when, way.rows, strict=True):
            place, turn, stamp = _vector(row[:3]), _quaternion(row), _stamp(time)
            pose = messages.Pose(position=place, orientation=turn)
            yield time, poses, messages.PoseInFrame(timestamp=stamp, frame_id=_WORLD, pose=pose)
            moved = messages.FrameTransform(
                timestamp=stamp,
                parent_frame_id=_WORLD,
                child_frame_id=frame,
                translation=place,
                rotation=turn,
            )
            yield time, frames, moved

    def _values(self, side: str, name: str, way: Way) -> Iterator[tuple[float, Any, Any]]:
        from foxglove import Channel  # noqa: PLC0415  # as above

        schema = {
            "type": "object",
            "title": "Value",
            "properties": {"value": {"type": "number"}, "unit": {"type": "string"}},
        }
        channel = Channel(_topic(side, name), schema=schema, context=self._context)
        for time, row in zip(way.when, way.rows, strict=True):
            yield time, channel, {"value": row[0], "unit": way.track.unit}

    def _events(self, side: str) -> Iterator[tuple[float, Any, Any]]:
        from foxglove import channels, messages  # noqa: PLC0415  # as above

        levels = {
            Weight.READING: messages.LogLevel.Debug,
            Weight.COMMAND: messages.LogLevel.Info,
            Weight.FAULT: messages.LogLevel.Warning,
        }
        channel = channels.LogChannel(f"/{side}/log", context=self._context)
        for one in events(self._shown, dict(self._shown.sides)[side]):
            line = messages.Log(
                timestamp=_stamp(one.time), level=levels[one.weight], message=one.text, name=side,
                file=one.file, line=one.line,
            )  # fmt: skip
            yield one.time, channel, line


def _things(ways: dict[str, Way]) -> Iterable[tuple[str, Way]]:
    return ((name, way) for name, way in ways.items() if way.track.kind is not Kind.VALUE)


def _topic(*parts: str) -> str:
    return "/" + "/".join(part.replace(" ", "_") for part in parts)


def _about(shown: Shown) -> dict[str, str]:
    found = {
        "mutant": str(shown.number),
        "id": shown.id,
        "what": shown.what,
        "test": shown.test,
        "round": str(shown.round + 1),
        "clock": shown.clock,
        "story": shown.story,
        "fault": "" if shown.fault is None else f"{shown.fault:.3f} s",
    }
    return {name: text for name, text in found.items() if text}


def _block(block: Block) -> messages.SceneEntity:
    from foxglove import messages  # noqa: PLC0415  # as above

    colour = (*(block.colour or _BLOCK), 1.0)[:4]
    pose = messages.Pose(position=_vector(block.centre), orientation=_quaternion(()))
    cube = messages.CubePrimitive(pose=pose, size=_vector(block.size), color=_colour(colour))
    return messages.SceneEntity(frame_id=_WORLD, id=block.name, cubes=[cube])


def _shape(frame: str, way: Way, colour: Iterable[float]) -> messages.SceneEntity:
    """A box, or a small ball for what has no size."""
    from foxglove import messages  # noqa: PLC0415  # as above

    pose = messages.Pose(position=_vector((0.0, 0.0, 0.0)), orientation=_quaternion(()))
    size, seen = way.track.size, _colour(colour)
    if size is not None:
        cube = messages.CubePrimitive(pose=pose, size=_vector(size), color=seen)
        return messages.SceneEntity(frame_id=frame, id=frame, frame_locked=True, cubes=[cube])
    ball = messages.SpherePrimitive(pose=pose, size=_vector((_DOT, _DOT, _DOT)), color=seen)
    return messages.SceneEntity(frame_id=frame, id=frame, frame_locked=True, spheres=[ball])


def _path(name: str, way: Way, colour: Iterable[float]) -> messages.SceneEntity:
    from foxglove import messages  # noqa: PLC0415  # as above

    points = [messages.Point3(x=x, y=y, z=z) for x, y, z in way.outline]
    pose = messages.Pose(position=_vector((0.0, 0.0, 0.0)), orientation=_quaternion(()))
    line = messages.LinePrimitive(pose=pose, thickness=_LINE, points=points, color=_colour(colour))
    return messages.SceneEntity(frame_id=_WORLD, id=f"path of {name}", lines=[line])


def _vector(numbers: Iterable[float]) -> messages.Vector3:
    from foxglove import messages  # noqa: PLC0415  # as above

    x, y, z = numbers
    return messages.Vector3(x=x, y=y, z=z)


def _quaternion(row: tuple[float, ...]) -> messages.Quaternion:
    """The orientation in a row of a track; none in one of a mere position."""
    from foxglove import messages  # noqa: PLC0415  # as above

    w, x, y, z = row[3:7] if len(row) == 7 else (1.0, 0.0, 0.0, 0.0)
    return messages.Quaternion(x=x, y=y, z=z, w=w)


def _colour(parts: Iterable[float]) -> messages.Color:
    from foxglove import messages  # noqa: PLC0415  # as above

    r, g, b, a = parts
    return messages.Color(r=r, g=g, b=b, a=a)


def _stamp(time: float) -> messages.Timestamp:
    from foxglove import messages  # noqa: PLC0415  # as above

    return messages.Timestamp.from_epoch_secs(time)
