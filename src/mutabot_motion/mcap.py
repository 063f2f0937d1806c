"""Writes recordings for Foxglove and other MCAP readers. Needs foxglove-sdk: ``mutabot[mcap]``.

Foxglove's own library rather than a bare MCAP writer: it brings the schemas that its panels know.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import foxglove
from foxglove import channels, messages

from mutabot.api.reports import RecordedPaths

from .view import BLOCK, COLOURS, Coordinates, DrawnBlock, MotionView, Weight, events, things_in, values_in

READER = "Foxglove"
_WORLD = "world"
#: m
_LINE, _DOT = 0.006, 0.024


def write(file: Path, view: MotionView) -> None:
    """Write a recording to a file; its times are those of the recording's clock, from 0."""
    context = foxglove.Context()
    file.unlink(missing_ok=True)
    with foxglove.open_mcap(str(file), context=context) as writer:
        writer.write_metadata("mutabot", view.about)
        _FileTopics(view, context).log()


class _FileTopics:
    """The topics of a file."""

    def __init__(self, view: MotionView, context: Any) -> None:
        self._view, self._context = view, context

    def log(self) -> None:
        """Write the messages in the order of their times."""
        found = [line for side, recorded in self._view.sides for line in self._lines(side, recorded)]
        for time, channel, message in [*self._scene(), *sorted(found, key=lambda line: line[0])]:
            channel.log(message, log_time=round(time * 1e9))

    def _scene(self) -> Iterator[tuple[float, Any, Any]]:
        """Yield the surroundings and the paths, which exist from the start."""
        yield self._shapes("/blocks", [_block(block) for block in self._view.blocks])
        for side, recorded in self._view.sides:
            paths = [_path(recorded, name, _colour(side)) for name in things_in(recorded)]
            yield self._shapes(f"/{side}/paths", paths)

    def _shapes(self, topic: str, entities: list[Any]) -> tuple[float, Any, Any]:
        channel = channels.SceneUpdateChannel(topic, context=self._context)
        return 0.0, channel, messages.SceneUpdate(entities=entities)

    def _lines(self, side: str, recorded: RecordedPaths) -> Iterator[tuple[float, Any, Any]]:
        for name in things_in(recorded):
            yield from self._poses(side, name, recorded)
        for name in values_in(recorded):
            yield from self._values(side, name, recorded)
        yield from self._events(side, recorded)

    def _poses(self, side: str, name: str, recorded: RecordedPaths) -> Iterator[tuple[float, Any, Any]]:
        """Yield the poses of things; each thing has a frame of its own, in which its shape is at rest."""
        frame, path = f"{side}/{name}", recorded.paths[name]
        shape = _shape(frame, path.track.size, _colour(side))
        yield self._shapes(_topic(side, name, "shape"), [shape])
        poses = channels.PoseInFrameChannel(_topic(side, name, "pose"), context=self._context)
        frames = channels.FrameTransformChannel(_topic(side, name, "frame"), context=self._context)
        for time, row in zip(path.when, path.rows, strict=True):
            pose, stamp = _pose(row), messages.Timestamp.from_epoch_secs(time)
            yield time, poses, messages.PoseInFrame(timestamp=stamp, frame_id=_WORLD, pose=pose)
            moved = messages.FrameTransform(
                timestamp=stamp,
                parent_frame_id=_WORLD,
                child_frame_id=frame,
                translation=_vector(row[:3]),
                rotation=_orientation(row),
            )
            yield time, frames, moved

    def _values(self, side: str, name: str, recorded: RecordedPaths) -> Iterator[tuple[float, Any, Any]]:
        path = recorded.paths[name]
        schema = {
            "type": "object",
            "title": "Value",
            "properties": {"value": {"type": "number"}, "unit": {"type": "string"}},
        }
        channel = foxglove.Channel(_topic(side, name), schema=schema, context=self._context)
        for time, row in zip(path.when, path.rows, strict=True):
            yield time, channel, {"value": row[0], "unit": path.track.unit}

    def _events(self, side: str, recorded: RecordedPaths) -> Iterator[tuple[float, Any, Any]]:
        levels = {
            Weight.READING: messages.LogLevel.Debug,
            Weight.COMMAND: messages.LogLevel.Info,
            Weight.FAULT: messages.LogLevel.Warning,
        }
        channel = channels.LogChannel(f"/{side}/log", context=self._context)
        for event in events(self._view, recorded):
            line = messages.Log(
                timestamp=messages.Timestamp.from_epoch_secs(event.time), level=levels[event.weight],
                message=event.text, name=side, file=event.file, line=event.line,
            )  # fmt: skip
            yield event.time, channel, line


def _topic(*parts: str) -> str:
    return "/" + "/".join(part.replace(" ", "_") for part in parts)


def _block(block: DrawnBlock) -> Any:
    name, centre, size, wanted = block
    red, green, blue, *opacity = wanted or (*(part / 255 for part in BLOCK), 0.4)
    colour = messages.Color(r=red, g=green, b=blue, a=opacity[0] if opacity else 1.0)
    cube = messages.CubePrimitive(pose=_pose(centre), size=_vector(size), color=colour)
    return messages.SceneEntity(frame_id=_WORLD, id=name, cubes=[cube])


def _shape(frame: str, size: Coordinates | None, colour: Any) -> Any:
    """Return a box, or a small sphere for a thing without a size."""
    about: dict[str, Any] = {"frame_id": frame, "id": frame, "frame_locked": True}
    pose = _pose((0.0, 0.0, 0.0))
    if size is not None:
        cube = messages.CubePrimitive(pose=pose, size=_vector(size), color=colour)
        return messages.SceneEntity(**about, cubes=[cube])
    ball = messages.SpherePrimitive(pose=pose, size=_vector((_DOT, _DOT, _DOT)), color=colour)
    return messages.SceneEntity(**about, spheres=[ball])


def _path(recorded: RecordedPaths, name: str, colour: Any) -> Any:
    points = [messages.Point3(x=x, y=y, z=z) for x, y, z in recorded.paths[name].outline]
    line = messages.LinePrimitive(pose=_pose((0.0, 0.0, 0.0)), thickness=_LINE, points=points, color=colour)
    return messages.SceneEntity(frame_id=_WORLD, id=f"path of {name}", lines=[line])


def _pose(row: Sequence[float]) -> Any:
    """Return the pose in a row of a track."""
    return messages.Pose(position=_vector(row[:3]), orientation=_orientation(row))


def _orientation(row: Sequence[float]) -> Any:
    """Return the orientation in a row; identity if the row is only a position."""
    w, x, y, z = row[3:7] if len(row) == 7 else (1.0, 0.0, 0.0, 0.0)
    return messages.Quaternion(x=x, y=y, z=z, w=w)


def _vector(numbers: Iterable[float]) -> Any:
    x, y, z = numbers
    return messages.Vector3(x=x, y=y, z=z)


def _colour(side: str) -> Any:
    red, green, blue = (part / 255 for part in COLOURS[side])
    return messages.Color(r=red, g=green, b=blue, a=1.0)
