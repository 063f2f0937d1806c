"""The sensors that a robot program can read, each with its own noise, rate and delay."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import mujoco
import numpy as np

from mutabot_cell.models.noise import SeededNoise
from mutabot_cell.models.sleeping import awake
from mutabot_cell.motion.kinematics import Kinematics

from .errors import SensorError
from .geometry import Array, Pose, Position, pose_of
from .light_barrier import SOLID, LightBarriers
from .parts import Part
from .robot import Robot
from .scene import Scene
from .simulation import TICK, Simulation

DISTANCE_RANGE = (0.02, 2.0)
"""Range of the distance sensor, m; further away it reads its upper end."""


class Sensors:
    """Readings of the cell. World frame unless stated otherwise.

    Attributes:
        light_barriers: those of the scene.
        camera: where the camera stands, shape (3,), world frame, m.
        hidden: functions that say, once for each picture, whether the camera sees no part in it.
        balls: what else hides parts from the camera: the middle of each, shape (3,), m, and its radius, m.
    """

    def __init__(
        self,
        simulation: Simulation,
        robot: Robot,
        kinematics: Kinematics,
        noise: SeededNoise,
        scene: Scene,
        numbers: dict[str, int],
    ) -> None:
        self._simulation = simulation
        self._robot = robot
        tool = robot.model.tool
        self._palm = 0.0 if tool is None else tool.palm
        self._own_body = -1 if tool is None else simulation.id_of("body", robot.prefix + tool.body)
        self.light_barriers = LightBarriers(simulation, scene.light_barriers)
        self._kinematics = kinematics
        self._noise = noise
        self._parts = {part.name: part for part in scene.parts}
        self._numbers = numbers
        self._geom = np.zeros(1, dtype=np.int32)
        self._read: tuple[int, tuple[float, ...]] = (-1, ())
        self._seen_at = -1
        self._seen: dict[str, Position | None] = {}
        self._picture = mujoco.MjData(simulation.model)
        self.camera: Array = np.array(scene.camera)
        self.hidden: list[Callable[[], bool]] = []
        self.balls: list[tuple[Array, float]] = []
        self._ranged: tuple[int, float] = (-1, 0.0)

    def tool_pose(self) -> Pose:
        """Return the tool pose in the base frame, computed from the joint encoders.

        Like a real controller's, it knows nothing of a wrong calibration, a bent link or a moved base.
        """
        return pose_of(*self._kinematics.tool(np.radians(self._encoders())))

    def joint_angles(self) -> tuple[float, ...]:
        """Return the measured joint angles, degrees, each in (-180, 180]."""
        return self._wrapped_encoders()

    def box_position(self, name: str | None = None) -> Position:
        """Return the centre of a box's bottom face as the camera sees it; of the first box without a name.

        The camera takes 25 pictures a second. Each can be read 40 ms later, and until the next one can.

        Raises:
            SensorError: there is no such box, or something hides it from the camera.
        """
        box = self._box(name)
        tick, places = self._simulation.frame()
        if tick != self._seen_at:
            self._seen_at, self._seen = tick, {}
            self._picture.qpos[:] = places
            with awake(self._simulation.model):
                mujoco.mj_kinematics(self._simulation.model, self._picture)
        if box.name not in self._seen:
            self._seen[box.name] = self._look_for(box)
        found = self._seen[box.name]
        if found is None:
            raise SensorError(f"the camera does not see {box.name!r}: something is in the way")
        return found

    def picture_time(self) -> float:
        """Return the simulated time, s, of the picture that `box_position` reads now."""
        return self._simulation.frame()[0] * TICK

    def _look_for(self, box: Part) -> Position | None:
        """Return where the picture shows the box; None if less than a third of it is visible."""
        body, geom = self._simulation.id_of("body", box.name), self._simulation.model.geom(box.name).id
        centre, rotation = self._picture.xpos[body], self._picture.xmat[body].reshape(3, 3)
        rays = centre + np.array(box.points()) @ rotation.T - self.camera
        hits = np.zeros(len(rays), dtype=np.int32)
        for index, ray in enumerate(rays):
            mujoco.mj_ray(
                self._simulation.model,
                self._picture,
                self.camera,
                ray,
                SOLID,
                1,
                -1,
                hits[index : index + 1],
            )
        seen = (hits == geom) & np.logical_not(self._hidden_by_balls(rays))
        is_hidden = [hides() for hides in self.hidden]
        if 3 * int(seen.sum()) < len(rays) or any(is_hidden):
            return None
        bottom = (centre + rotation @ box.foot).tolist()
        return Position(*(self._noise.add("box position", value) for value in bottom))

    def _hidden_by_balls(self, rays: Array) -> Array:
        """Return which of these rays from the camera, shape (rays, 3), a ball blocks."""
        found = np.zeros(len(rays), dtype=bool)
        for centre, radius in self.balls:
            way = centre - self.camera
            along = np.clip(rays @ way / (rays * rays).sum(axis=1), 0.0, 1.0)
            found |= np.linalg.norm(along[:, None] * rays - way, axis=1) < radius
        return found

    def colour_number(self, name: str | None = None) -> int:
        """Return the colour as a whole number 1..10: even is red, odd is blue. Drawn once per round.

        Raises:
            SensorError: there is no such box.
        """
        return self._numbers[self._box(name).name]

    def colour(self, name: str | None = None) -> str:
        """Return the colour as a label, "red" or "blue".

        Raises:
            SensorError: there is no such box.
        """
        return "red" if self.colour_number(name) % 2 == 0 else "blue"

    def distance(self) -> float:
        """Return the distance from the palm to the nearest surface along the tool's axis, m; one per tick."""
        ticks, reading = self._ranged
        if ticks != self._simulation.ticks:
            low, high = DISTANCE_RANGE
            reading = min(max(self._noise.add("distance", self._range()), low), high)
            self._ranged = self._simulation.ticks, reading
        return reading

    def _range(self) -> float:
        data = self._simulation.data
        axis = data.site_xmat[self._robot.site].reshape(3, 3)[:, 2].copy()
        start = data.site_xpos[self._robot.site] + self._palm * axis
        found = mujoco.mj_ray(self._simulation.model, data, start, axis, SOLID, 1, self._own_body, self._geom)
        return DISTANCE_RANGE[1] if found < 0 else float(found)

    def _wrapped_encoders(self) -> tuple[float, ...]:
        return tuple(180.0 - (180.0 - angle) % 360.0 for angle in self._encoders())

    def _encoders(self) -> tuple[float, ...]:
        """Return one reading of all encoders per tick, with noise, degrees, not wrapped."""
        ticks, read = self._read
        if ticks != self._simulation.ticks:
            angles = np.degrees(self._robot.encoders()).tolist()
            read = tuple(self._noise.add("joint angle", angle) for angle in angles)
            self._read = self._simulation.ticks, read
        return read

    def _box(self, name: str | None) -> Part:
        if name is None and self._parts:
            return next(iter(self._parts.values()))
        if name not in self._parts:
            known = ", ".join(self._parts) or "none"
            raise SensorError(f"no box named {name!r} in the cell; there are: {known}")
        return self._parts[name]


def true_box_position(simulation: Simulation, box: Part) -> Position:
    """Return the exact centre of the box's bottom face (the one below at the start), world frame."""
    body = simulation.id_of("body", box.name)
    centre = simulation.data.xpos[body]
    foot = simulation.data.xmat[body].reshape(3, 3) @ box.foot
    return Position(*(centre + foot).tolist())


def true_box_tilt(simulation: Simulation, box: Part) -> float:
    """Return the exact angle between the box's own up and the world's up, degrees."""
    body = simulation.id_of("body", box.name)
    return math.degrees(math.acos(min(1.0, max(-1.0, float(simulation.data.xmat[body][6:] @ box.up)))))


def true_speed(simulation: Simulation, kind: Literal["body", "site"], number: int) -> float:
    """Return the exact speed of a body's origin or of a site, m/s."""
    found = np.zeros(6)
    which = mujoco.mjtObj.mjOBJ_SITE if kind == "site" else mujoco.mjtObj.mjOBJ_XBODY
    mujoco.mj_objectVelocity(simulation.model, simulation.data, which, number, found, 0)
    return math.hypot(*found[3:].tolist())
