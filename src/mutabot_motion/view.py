"""What was recorded in MuJoCo's viewer: both sides in one world. Needs MuJoCo: ``mutabot[cells]``.

It shows what a simulator told, whichever that was: tool and things as they moved, their paths, what stands
around. The original is the pale one.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable
from itertools import pairwise
from math import dist
from textwrap import wrap
from xml.sax.saxutils import quoteattr

import mujoco
from mujoco import viewer

from mutabot.errors import UsageError
from mutabot.evidence.recording import Kind
from mutabot.evidence.tracks import Path as Way

from .pictures.lettering import letters_of_english
from .shown import BLOCK, COLOURS, Shown, end_of, things_in
from .sights import has_screen

#: how much of each side is seen
_OPACITY = {"original": 0.4, "mutant": 1.0}
#: m: the world that is shown is at least this large
_LEAST = 0.5
#: letters in a line of text: the font of the viewer has those of English alone
_LETTERS = 72
#: seconds between two pictures, and by how much the arrow keys go
_FRAME, _STEP = 1 / 60, 0.1
#: seconds in which the window comes up, and has a camera of its own
_BEGINNING = 1.0
#: keys as GLFW numbers them
_SPACE, _RIGHT, _LEFT, _HOME = 32, 262, 263, 268


def need_screen() -> None:
    """Raise UsageError where there is no screen."""
    if not has_screen():
        raise UsageError(
            "--view needs a screen, and there is none (DISPLAY is not set); --video FILE.mp4, "
            "--rrd FILE.rrd and --mcap FILE.mcap do without"
        )


def show(shown: Shown) -> str:
    """Show it until the window is closed. Raises UsageError if there is nothing to show."""
    stage = Stage(shown)
    if not stage.things:
        raise UsageError(
            "--view has nothing to show: no simulator tells where things are, see docs/motion.md"
        )
    _watch(stage)
    return "the window was closed"


class Stage:
    """A world of what was recorded.

    Attributes:
        model, data: of MuJoCo; nothing in it moves by itself.
        things: by name of its body, what moves.
        end: the last moment, s.
    """

    def __init__(self, shown: Shown) -> None:

        self.shown = shown
        self.things = {f"{side} {name}": way for side, name, way in _things(shown)}
        self.end = max((end_of(recording) for _, recording in shown.sides), default=0.0)
        self.model = mujoco.MjModel.from_xml_string(_world(shown))
        self.data = mujoco.MjData(self.model)
        self.at(0.0)

    def at(self, time: float) -> None:
        """Put everything where it was at a time, s."""

        for name, way in self.things.items():
            row = way.rows[way.at(time)]
            number = self.model.body(name).mocapid[0]
            self.data.mocap_pos[number] = row[:3]
            if way.track.kind is Kind.POSE:
                self.data.mocap_quat[number] = row[3:7]
        self.data.time = time
        mujoco.mj_forward(self.model, self.data)

    def said(self, time: float) -> str:
        """What there is to say at a time, s."""
        fault, apart = self.shown.fault, self.shown.apart
        lines = [self.shown.title, f"{time:.2f} of {self.end:.2f} s"]
        if fault is not None:
            lines.append(f"fault at {fault:.2f} s" if time < fault else f"FAULT since {fault:.2f} s")
        if self.shown.story and (apart is None or time >= apart):
            lines.append(self.shown.story)
        return "\n".join(part for line in lines for part in wrap(letters_of_english(line), _LETTERS))


class _Clock:
    """The time that is shown: it runs as the clock on the wall does, and keys change it."""

    def __init__(self, end: float) -> None:
        self.time, self._end = 0.0, end
        self._runs, self._last = True, time.monotonic()

    def key(self, number: int) -> None:
        """A key was pressed."""
        if number == _SPACE:
            self._runs = not self._runs
        elif number == _HOME:
            self.time = 0.0
        elif number in (_LEFT, _RIGHT):
            self._runs = False
            self._go(_STEP if number == _RIGHT else -_STEP)

    def tick(self) -> float:
        """The time to be shown now, s."""
        now = time.monotonic()
        if self._runs:
            self._go(now - self._last)
        self._last = now
        return self.time

    def _go(self, seconds: float) -> None:
        self.time = min(self._end, max(0.0, self.time + seconds))


def _watch(stage: Stage) -> None:

    clock = _Clock(stage.end)
    place = mujoco.mjtGridPos.mjGRID_TOPLEFT, mujoco.mjtGridPos.mjGRID_BOTTOMLEFT
    keys = "space: stop and go on\nleft, right: step\nhome: from the beginning"
    before = set(threading.enumerate())
    window = viewer.launch_passive(
        stage.model, stage.data, key_callback=clock.key, show_left_ui=False, show_right_ui=False
    )
    begun = time.monotonic()
    try:
        while window.is_running():
            now = clock.tick()
            with window.lock():
                stage.at(now)
                if time.monotonic() < begun + _BEGINNING:
                    mujoco.mjv_defaultFreeCamera(stage.model, window.cam)
            window.set_texts([(None, place[0], stage.said(now), ""), (None, place[1], keys, "")])
            window.sync()
            time.sleep(_FRAME)
    finally:
        window.close()
        for thread in set(threading.enumerate()) - before:  # what draws must not be cut off
            thread.join(_BEGINNING)


def _things(shown: Shown) -> list[tuple[str, str, Way]]:
    return [(side, name, way) for side, found in shown.sides for name, way in things_in(found)]


def _colour(side: str) -> str:
    return _numbers((*(part / 255 for part in COLOURS[side]), _OPACITY[side]))


def _world(shown: Shown) -> str:
    """The model, as MuJoCo's XML."""
    grey = tuple(part / 255 for part in BLOCK)
    parts = [
        f'<geom type="box" pos={_numbers(one.centre)} size={_numbers(edge / 2 for edge in one.size)} '
        f"rgba={_numbers((*(one.colour or grey), 1.0)[:4])}/>"
        for one in shown.blocks
    ]
    for side, name, way in _things(shown):
        parts.append(f'<body name={quoteattr(f"{side} {name}")} mocap="true">{_shape(side, way)}</body>')
        corners = [" ".join(f"{number:.5g}" for number in point) for point in way.outline]
        parts += (
            f'<geom type="capsule" size="0.003" fromto="{one} {other}" rgba={_colour(side)}/>'
            for one, other in pairwise(corners)
            if one != other
        )
    points = [point for _, _, way in _things(shown) for point in way.points] or [(0.0, 0.0, 0.0)]
    least, most = (tuple(map(pick, zip(*points, strict=True))) for pick in (min, max))
    centre = _numbers((one + other) / 2 for one, other in zip(least, most, strict=True))
    return (
        f'<mujoco><statistic center={centre} extent="{max(_LEAST, dist(least, most)):.3g}"/>'
        '<visual><headlight ambient="0.4 0.4 0.4"/><global azimuth="90" elevation="-35"/></visual>'
        '<asset><texture type="skybox" builtin="gradient" rgb1="0.8 0.85 0.9" rgb2="0.55 0.6 0.66" '
        'width="256" height="256"/></asset>'
        '<default><geom contype="0" conaffinity="0"/></default>'
        '<worldbody><light pos="0 0 4" dir="0 0 -1" castshadow="false"/>'
        f"{''.join(parts)}</worldbody></mujoco>"
    )


def _shape(side: str, way: Way) -> str:
    colour = _colour(side)
    if way.track.size is not None:
        return f'<geom type="box" size={_numbers(edge / 2 for edge in way.track.size)} rgba={colour}/>'
    ball = f'<geom type="sphere" size="0.012" rgba={colour}/>'
    if way.track.kind is not Kind.POSE:
        return ball
    axes = (
        f'<geom type="capsule" size="0.004" fromto="0 0 0 {end}" rgba="{shade} 1"/>'
        for end, shade in zip(
            ("0.06 0 0", "0 0.06 0", "0 0 0.06"), ("1 0 0", "0 0.8 0", "0 0 1"), strict=True
        )
    )
    return ball + "".join(axes)


def _numbers(numbers: Iterable[float]) -> str:
    return quoteattr(" ".join(f"{number:.6g}" for number in numbers))
