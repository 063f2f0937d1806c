"""Writes recordings for Rerun's viewer. Needs rerun-sdk: ``mutabot[rerun]``.

Writing sends nothing anywhere. The viewer would send its maker how it is used; the one that is opened here is
disabled by Rerun's own command, in a folder of its own: what the user has set for himself stays.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import rerun
from rerun import blueprint as layout

from mutabot.api.reports import RecordedPaths, UsageError

from .view import BLOCK, COLOURS, DrawnBlock, MotionView, Weight, events, things_in, values_in
from .viewers import has_screen

READER = "Rerun"
#: seconds after which a viewer that cannot begin has ended
_BEGINNING = 4.0
#: m: half the width of paths, and what stands for things without a size
_LINE, _DOT, _AXIS = 0.003, 0.012, 0.06


def write(file: Path, view: MotionView) -> None:
    """Write a recording to a file, with the layout of the viewer."""
    about = "\n\n".join(f"**{name}** {text}" for name, text in view.about.items())
    name = f"mutant {view.number}, round {view.round + 1}: {view.test}"
    with rerun.RecordingStream("mutabot", recording_id=f"{view.id} {view.round} {view.test}") as stream:
        stream.set_log_time_enabled(False)
        stream.set_log_tick_enabled(False)
        stream.save(str(file), default_blueprint=_layout(view))
        stream.send_recording_name(name)
        stream.log("about", rerun.TextDocument(about, media_type="text/markdown"), static=True)
        stream.log("/", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        for block in view.blocks:
            _log_block(stream, block)
        for side, recorded in view.sides:
            _Side(stream, view, side, recorded).log()
        stream.flush()
        stream.disconnect()


class _Side:
    """Original or mutant in a recording for Rerun."""

    def __init__(
        self, stream: rerun.RecordingStream, view: MotionView, name: str, recorded: RecordedPaths
    ) -> None:
        self._stream, self._view, self._name, self._recorded = stream, view, name, recorded
        self._colour = COLOURS[name]

    def log(self) -> None:
        for name in things_in(self._recorded):
            self._log_thing(name)
        for name in self._recorded.lines:
            self._log_line(name)
        for name in values_in(self._recorded):
            self._log_value(name)
        self._log_events()

    def _log_thing(self, name: str) -> None:
        path, way = self._path("things", name), self._recorded.paths[name]
        turned: dict[str, Any] = {}
        if way.track.kind == "pose":
            turned["quaternion"] = [(*row[4:7], row[3]) for row in way.rows]  # x, y, z, w
        moved = rerun.Transform3D.columns(translation=way.points, **turned)
        self._stream.send_columns(path, [self._times(way.when)], moved)
        shape: Any = rerun.Points3D(
            [(0, 0, 0)], radii=_DOT, colors=self._colour, labels=f"{self._name} {name}"
        )
        if way.track.size is not None:
            label = f"{self._name} {name}"
            shape = rerun.Boxes3D(
                sizes=[way.track.size], colors=self._colour, labels=label, show_labels=False
            )
        elif way.track.kind == "pose":
            self._stream.log(path, rerun.TransformAxes3D(_AXIS), static=True)
        self._stream.log(path, shape, static=True)
        line = rerun.LineStrips3D([way.points], radii=_LINE, colors=self._colour)
        self._stream.log(self._path("paths", name), line, static=True)

    def _log_line(self, name: str) -> None:
        """Log an arm at each time; in Rerun a strip has one thickness."""
        line = self._recorded.lines[name]
        path, strips = self._path("robot", name), [_points(row) for row in line.rows]
        radius = sum(line.track.radii) / len(line.track.radii)
        moved = rerun.LineStrips3D.columns(strips=strips)
        self._stream.log(path, rerun.LineStrips3D.from_fields(radii=radius, colors=self._colour), static=True)
        self._stream.send_columns(path, [self._times(line.when)], moved)

    def _log_value(self, name: str) -> None:
        path, way = self._path("values", name), self._recorded.paths[name]
        unit = f", {way.track.unit}" if way.track.unit else ""
        line = rerun.SeriesLines(colors=self._colour, names=f"{self._name}: {name}{unit}")
        self._stream.log(path, line, static=True)
        found = rerun.Scalars.columns(scalars=[row[0] for row in way.rows])
        self._stream.send_columns(path, [self._times(way.when)], found)

    def _log_events(self) -> None:
        levels = {Weight.READING: "DEBUG", Weight.COMMAND: "INFO", Weight.FAULT: "WARN"}
        found = events(self._view, self._recorded)
        if found:
            where = [f" ({event.file}:{event.line})" if event.file else "" for event in found]
            texts = [f"{event.text}{place}" for event, place in zip(found, where, strict=True)]
            lines = rerun.TextLog.columns(text=texts, level=[levels[event.weight] for event in found])
            self._stream.send_columns(self._path("log"), [self._times(event.time for event in found)], lines)

    def _times(self, times: Iterable[float]) -> rerun.TimeColumn:
        return rerun.TimeColumn(self._view.clock, duration=list(times))

    def _path(self, *parts: str) -> str:
        return str(rerun.new_entity_path([self._name, *parts]))


def _points(row: Sequence[float]) -> list[Sequence[float]]:
    return [row[start : start + 3] for start in range(0, len(row), 3)]


def _log_block(stream: rerun.RecordingStream, block: DrawnBlock) -> None:
    name, centre, size, wanted = block
    colour = tuple(round(255 * part) for part in wanted) if wanted is not None else (*BLOCK, 90)
    box = rerun.Boxes3D(
        centers=[centre], sizes=[size], colors=[colour], fill_mode="solid",
        labels=[name], show_labels=False,
    )  # fmt: skip
    stream.log(rerun.new_entity_path(["blocks", name]), box, static=True)


def _layout(view: MotionView) -> Any:
    below = [layout.TextLogView(origin=side, name=side) for side, _ in view.sides]
    values = layout.TimeSeriesView(name="values", contents=[f"+ /{side}/values/**" for side, _ in view.sides])
    space = layout.Spatial3DView(origin="/", name="world")
    about = layout.TextDocumentView(origin="about", name="about")
    right = layout.Vertical(about, values, row_shares=[1, 2])
    top = layout.Horizontal(space, right, column_shares=[3, 2])
    return layout.Blueprint(
        layout.Vertical(top, layout.Horizontal(*below), row_shares=[3, 1]),
        layout.TimePanel(timeline=view.clock),
        collapse_panels=True,
    )


def open_viewer(file: Path, home: Path) -> str:
    """Open Rerun's viewer, which outlives this process. Return a description of the result.

    Without a screen it is not opened. Raises UsageError if it does not begin.
    """
    if not has_screen():
        return f"there is no screen to open its viewer on: look at it elsewhere, with `rerun {file.name}`"
    settings = home / "rerun"
    settings.mkdir(exist_ok=True)
    log = settings / "viewer.log"
    environment = {**os.environ, "XDG_CONFIG_HOME": str(settings)}
    command = [sys.executable, "-m", "rerun_cli"]
    with log.open("wb") as output:
        common: dict[str, Any] = {
            "stdin": subprocess.DEVNULL, "stdout": output, "stderr": subprocess.STDOUT, "env": environment,
        }  # fmt: skip
        try:
            subprocess.run([*command, "analytics", "disable"], check=True, **common)
            # its server would listen to the whole network, and an older viewer would take the file
            local = ["--bind", "127.0.0.1", "--port", "auto"]
            viewer = subprocess.Popen([*command, *local, str(file)], start_new_session=True, **common)
        except (OSError, subprocess.CalledProcessError) as error:
            raise UsageError(f"the viewer of Rerun does not begin: {error}; {file} is written") from error
    try:
        viewer.wait(_BEGINNING)
    except subprocess.TimeoutExpired:
        return "its viewer is open"
    if viewer.returncode == 0:
        return "its viewer was closed"
    last = log.read_text(encoding="utf-8", errors="replace").strip().rpartition("\n")[2]
    return f"its viewer ended at once: {last}"
