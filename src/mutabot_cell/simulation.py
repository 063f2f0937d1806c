"""The physics and its clock. Every advance of simulated time goes through `Simulation.tick`."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Mapping
from typing import Literal

import mujoco
import numpy as np

from mutabot_cell.models.assembly import build_cell
from mutabot_cell.models.options import PHYSICS_STEP
from mutabot_cell.models.robot import RobotModel

from .errors import SimulationDiverged
from .geometry import Array
from .lookahead import Lookahead
from .robot import Robot
from .scene import Scene
from .stepping import Stepping
from .stretch import Stretch

STEPS_PER_TICK = 5
TICK = STEPS_PER_TICK * PHYSICS_STEP
"""Length of one control tick, s."""

FRAME_TICKS = 4
"""Control ticks from one picture of the cell's camera to the next: 25 a second."""
LATENCY_TICKS = 4
"""Control ticks that a picture is older than this when it can be read: 40 ms."""

_ABSURD_SPEED = 1e4
_KEPT_FRAMES = 1 + math.ceil(LATENCY_TICKS / FRAME_TICKS)


class Simulation:
    """The model and state of the cell, and its time.

    Attributes:
        scene: what stands around the robots, as it was built.
        robots: by the prefix of their names.
        setpoints: wanted inputs of all servos for the coming tick, shape (STEPS_PER_TICK, servos): joints in
            rad, fingers in the unit of their servo. Drivers fill it before each tick.
        before_tick: called before each tick, in order; they write `setpoints`.
        after_tick: called after each tick, in order; they may raise.
        travels: by the name of a belt's fixture, how far it has run, m; for pictures.
        lookahead: says of hooks how they do without being called at each tick.
        camera_interval: from one picture of the camera to the next, s; see `set_camera`.
        camera_latency: age of a picture when it can be read first, s.
    """

    def __init__(self, scene: Scene, robots: Mapping[str, RobotModel]) -> None:
        self.scene = scene
        self.model = build_cell(scene, robots)
        self.data = mujoco.MjData(self.model)
        self.robots = {
            prefix: Robot(self.model, self.data, robot, prefix) for prefix, robot in robots.items()
        }
        for robot in self.robots.values():
            robot.place_at_home()
        mujoco.mj_forward(self.model, self.data)
        self.setpoints: Array = np.tile(self.data.ctrl, (STEPS_PER_TICK, 1))
        self.before_tick: list[Callable[[], None]] = []
        self.after_tick: list[Callable[[], None]] = []
        self.travels: dict[str, Callable[[], float]] = {}
        self.lookahead = Lookahead()
        self._stepping = Stepping(self.model, self.data)
        self._stretch = Stretch(self.model, self.data, self._stepping, STEPS_PER_TICK)
        self._ticks = self._quiet = 0
        self.camera_interval, self.camera_latency = FRAME_TICKS * TICK, LATENCY_TICKS * TICK
        self._frames: deque[tuple[int, Array]] = deque([(0, self.data.qpos.copy())], maxlen=_KEPT_FRAMES)
        self._ids: dict[tuple[str, str], int] = {}
        # views of the physics' own memory
        self._speeds, self._places = self.data.qvel, self.data.qpos

    @property
    def time(self) -> float:
        """Simulated time since the cell was made, s."""
        return self._ticks * TICK

    @property
    def ticks(self) -> int:
        """The number of control ticks since the cell was made."""
        return self._ticks

    def frame(self) -> tuple[int, Array]:
        """Return the tick of the camera's newest readable picture, and `qpos` at that time."""
        latest, every = self._ticks - round(self.camera_latency / TICK), round(self.camera_interval / TICK)
        taken = (frame for frame in reversed(self._frames) if frame[0] <= latest and not frame[0] % every)
        return next(taken, self._frames[0])

    def set_camera(self, *, interval: float | None = None, latency: float | None = None) -> None:
        """Set the camera's interval and latency to larger values, from now on.

        Args:
            interval: from one picture to the next, s, rounded up to a multiple of 40 ms.
            latency: age of a picture when it can be read first, s, in whole control ticks.
        """
        step = FRAME_TICKS * TICK
        self.camera_interval = step * max(1, math.ceil((interval or self.camera_interval) / step - 1e-9))
        self.camera_latency = self.camera_latency if latency is None else max(latency, 0.0)
        kept = 1 + math.ceil((self.camera_latency + self.camera_interval) / step)
        self._frames = deque(self._frames, maxlen=max(kept, _KEPT_FRAMES))

    @property
    def robot(self) -> Robot:
        """The first robot, usually the only one."""
        return next(iter(self.robots.values()))

    def id_of(self, kind: Literal["body", "site"], name: str) -> int:
        """Return the number of a body or site of the model; cached, since checks need it at every tick."""
        found = self._ids.get((kind, name))
        if found is None:
            found = self._ids[kind, name] = int(getattr(self.model, kind)(name).id)
        return found

    def tick(self, most: int = 1) -> float:
        """Advance by one control tick (`TICK` s) and return the simulated time, s.

        Args:
            most: number of control ticks that may pass instead, where nothing has to decide in between. All
                is bit by bit the same as one by one.

        Raises:
            SimulationDiverged: the physics gave NaN or absurd speeds.
            ProtectiveStop, ConditionBroken: from the safety check and the monitors.
        """
        if most < 2 or not self._take_stretch(most):
            for drive in self.before_tick:
                drive()
            self._step()
        if not _are_sane(self._places, self._speeds):
            self._check_speeds()
        for check in self.after_tick:
            check()
        return self.time

    def _step(self) -> None:
        self._stepping.tick(self.setpoints)
        self._ticks += 1
        if self._ticks % FRAME_TICKS == 0:
            self._frames.append((self._ticks, self._places.copy()))

    def _take_stretch(self, most: int) -> bool:
        """Run at most a number of ticks, up to the first that needs a check; False if none ran."""
        stretch, lookahead = self._stretch, self.lookahead
        ticks = lookahead.write(self.before_tick, self.after_tick, stretch.inputs[:most])
        if ticks < 2:
            return False
        self._quiet = 0
        if not stretch.run(ticks, lookahead.notes):
            stretch.go_back(0)
            return False
        quiet = self._quiet_until(ticks - 1)
        if quiet < ticks - 1:
            ticks = quiet + 1
            stretch.go_back(ticks)
        lookahead.keep(stretch, ticks)
        self.setpoints[:] = stretch.inputs[ticks - 1]
        for number in range(-(self._ticks + 1) % FRAME_TICKS, ticks, FRAME_TICKS):
            self._frames.append((self._ticks + 1 + number, stretch.places[number].copy()))
        self._ticks += ticks
        return True

    def call_within_stretch(self, hook: Callable[[], None], number: int) -> None:
        """Call a hook that changes nothing after a tick of a stretch (its number), as after a single tick.

        Nothing is called if that tick, or one before, may be taken back because a check is needed.
        """
        ticks = number + 1
        if self._quiet_until(ticks) < ticks:
            return
        self._stretch.reach(number)
        self._ticks += ticks
        try:
            hook()
        finally:
            self._ticks -= ticks

    def _quiet_until(self, ticks: int) -> int:
        """Return a lower bound of the ticks at the start of the stretch that need no check."""
        known = self._quiet
        if known < ticks:
            self._quiet = self.lookahead.quiet(self._stretch, known, self._sane(known, ticks))
        return self._quiet

    def _sane(self, known: int, ticks: int) -> int:
        """Return after how many of the stretch's first ticks the physics was sane."""
        places, speeds = self._stretch.places[known:ticks], self._stretch.speeds[known:ticks]
        # two numbers stand for all; in doubt each tick is looked at
        if _are_sane(places.ravel(), speeds.ravel()):
            return ticks
        moments = zip(places, speeds, strict=True)
        return next((tick for tick, moment in enumerate(moments, known) if not _are_sane(*moment)), ticks)

    def _check_speeds(self) -> None:
        fastest = float(np.abs(self._speeds).max())
        if not fastest <= _ABSURD_SPEED or not math.isfinite(float(self._places.sum())):
            raise SimulationDiverged(time=self.time, reason=f"largest speed {fastest:.3g}")

    def advance(self, seconds: float) -> None:
        """Run whole ticks until at least `seconds` have passed (rounded to the nearest tick)."""
        end = self._ticks + round(seconds / TICK)
        while self._ticks < end:
            self.tick(end - self._ticks)


def _are_sane(places: Array, speeds: Array) -> bool:
    """Return whether one number shows that all are finite and no speed is absurd; False in doubt."""
    return bool(speeds.dot(speeds) < _ABSURD_SPEED**2 and math.isfinite(places.dot(places)))
