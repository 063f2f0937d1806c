"""The work cell: robot, gripper, sensors, scene and time."""

from __future__ import annotations

import copy
import hashlib
import math
import weakref
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from types import TracebackType

import daqp
import mujoco
import numpy as np
import ruckig

from mutabot_cell.display.feed import make_feed
from mutabot_cell.models.kinova import gen3
from mutabot_cell.models.noise import SeededNoise
from mutabot_cell.models.robot import RobotModel

from . import integrity
from .belt import ConveyorBelt
from .depth_camera import StereoCamera
from .errors import BadArgument
from .force_sensor import Wrench, true_wrench
from .geometry import Pose, Position
from .gripper import Gripper
from .monitors import Condition, MonitoredValues, Monitors
from .parts import Part
from .robot import Robot
from .scene import Scene
from .sensors import true_box_position, true_box_tilt, true_speed
from .simulation import Simulation
from .suction import Suction
from .system import RobotSystem

_current: weakref.ref[Cell] | None = None


class Truth:
    """The cell's exact state, for tests, monitors and mutabot; a robot program has sensors instead."""

    def __init__(
        self,
        simulation: Simulation,
        systems: Mapping[str, RobotSystem],
        parts: tuple[Part, ...],
        belts: Mapping[str, ConveyorBelt],
    ) -> None:
        self._simulation = simulation
        self._systems = systems
        self._belts = belts
        self._barriers = next(iter(systems.values())).sensors.light_barriers
        self._parts = {part.name: part for part in parts}

    def tool_pose(self, robot: str | None = None) -> Pose:
        """Return the exact tool pose, base frame; of the first robot unless another one is named."""
        return self._robot(robot).tool_pose()

    def tool_position(self, robot: str | None = None) -> Position:
        """Return the exact tool position, base frame; faster than the whole pose."""
        return self._robot(robot).tool_position()

    def box_position(self, name: str = "box") -> Position:
        """Return the exact centre of the box's bottom face, world frame."""
        return true_box_position(self._simulation, self._parts[name])

    def tool_speed(self, robot: str | None = None) -> float:
        """Return the exact speed of the tool point, m/s; of the first robot unless another one is named."""
        return true_speed(self._simulation, "site", self._robot(robot).site)

    def box_speed(self, name: str = "box") -> float:
        """Return the exact speed of the box's centre, m/s."""
        body = self._simulation.id_of("body", self._parts[name].name)
        return true_speed(self._simulation, "body", body)

    def box_tilt(self, name: str = "box") -> float:
        """Return the angle between the box's up and the world's up, degrees."""
        return true_box_tilt(self._simulation, self._parts[name])

    def belt_position(self, name: str | None = None) -> float:
        """Return how far a belt has run since the cell was made, m; the first one unless another is named."""
        return _belt_of(self._belts, name).true_position()

    def belt_speed(self, name: str | None = None) -> float:
        """Return the speed of a belt's surface, m/s; of the first one unless another is named."""
        return _belt_of(self._belts, name).true_speed()

    def opening(self, robot: str | None = None) -> float:
        """Return the distance between the pads, m; 0 without fingers."""
        return self._robot(robot).opening()

    def wrench(self, robot: str | None = None) -> Wrench:
        """Return the exact force and torque of the tool on the flange, in the flange's frame."""
        return Wrench(*true_wrench(self._simulation, self._robot(robot)).tolist())

    def vacuum(self, robot: str | None = None) -> float:
        """Return the exact vacuum in the suction cup, Pa below the atmosphere; 0 without one."""
        system = next(iter(self._systems.values())) if robot is None else self._systems[robot]
        return system.vacuum() or 0.0

    def world(self) -> dict[str, float]:
        """Return where all is and the simulated time as a flat dict: "box.x", "opening", "time" etc.

        Of several robots those that are named have their names before: "left/tool.z". In units of which a
        thousandth is little: m, degrees, s, kN ("force"), bar ("vacuum"); 1 for an interrupted light barrier.
        """
        state = {"time": self._simulation.time}
        for prefix, robot in self._simulation.robots.items():
            pose = robot.tool_pose()
            state |= {
                f"{prefix}opening": robot.opening(),
                f"{prefix}tool.x": pose.x,
                f"{prefix}tool.y": pose.y,
                f"{prefix}tool.z": pose.z,
                f"{prefix}tool.theta_x": pose.theta_x,
                f"{prefix}tool.theta_y": pose.theta_y,
                f"{prefix}tool.theta_z": pose.theta_z,
                f"{prefix}force": Wrench(*true_wrench(self._simulation, robot).tolist()).force / 1e3,
            }
        for name, system in self._systems.items():
            vacuum = system.vacuum()
            if vacuum is not None:
                state[f"{prefix_of(name)}vacuum"] = vacuum / 1e5
        for name in self._parts:
            position = self.box_position(name)
            state |= {f"{name}.x": position.x, f"{name}.y": position.y, f"{name}.z": position.z}
            state[f"{name}.tilt"] = self.box_tilt(name)
        state |= {f"{name}.travel": belt.true_position() for name, belt in self._belts.items()}
        return state | {name: float(self._barriers.true_state(name)) for name in self._barriers.names}

    def _robot(self, name: str | None) -> Robot:
        robots = self._simulation.robots
        return self._simulation.robot if name is None else robots[prefix_of(name)]


class Cell:
    """A robot, a gripper, sensors and their surroundings, in simulated time only.

    Same seed, same commands: bit-identical run (same versions, same machine).

        with Cell(seed=3) as cell:
            cell.arm.move_by(y=0.2)
            cell.gripper.command(1.0)
            cell.wait(1.5)

    Leaving the `with` block raises a condition that broke inside and was swallowed.

    Args:
        seed: of the round; box placement, colours and sensor noise are drawn from it.
        robot: with its tool; the published experiment's Kinova Gen3 by default.
        robots: several robots by their names, instead of one; they share the clock.
        scene: what stands around the robot; the published experiment's cell by default.
        noise: False makes all sensors exact (placement and colours are still drawn).
        grip_force: N at each pad; by default what the tool says (`Fingers.force`), 60 N for the 2F-85.
        finger_speed: m/s; likewise, 0.1 m/s.

    Attributes:
        arm, gripper, suction, sensors: as the robot program uses them; of the first robot.
        force_sensor: between the first robot's flange and its tool.
        robots: the same of each robot, by its name; "" is that of the only one.
        truth: the exact state, for tests and monitors only.
        simulation: the clock and the physics; `simulation.tick` is the one way time advances.
        feed: what the cell reports to mutabot while a test is recorded; a test may report more by it.
    """

    def __init__(
        self,
        seed: int = 0,
        *,
        robot: RobotModel | None = None,
        robots: Mapping[str, RobotModel] | None = None,
        scene: Scene | None = None,
        noise: bool = True,
        grip_force: float | None = None,
        finger_speed: float | None = None,
    ) -> None:
        global _current  # noqa: PLW0603  (the cell that `world` reports on)
        if isinstance(seed, bool) or not isinstance(seed, int):
            raise BadArgument(f"Expected a whole number but got seed={seed!r}")
        draws = SeededNoise(seed, enabled=noise)
        placed, numbers = _placed(scene or Scene(), draws)
        models = _named(robot, robots)
        self.simulation = Simulation(placed, {prefix_of(name): model for name, model in models.items()})
        self.robots = {
            name: RobotSystem(
                self.simulation,
                self.simulation.robots[prefix_of(name)],
                SeededNoise(seed, enabled=noise, scope=prefix_of(name)),
                placed,
                numbers,
                grip_force=grip_force,
                finger_speed=finger_speed,
            )
            for name in models
        }
        first = next(iter(self.robots.values()))
        self.arm, self.sensors, self.force_sensor = first.arm, first.sensors, first.force_sensor
        self._belts = {
            fixture.name: ConveyorBelt(self.simulation, fixture.name, fixture.belt, draws)
            for fixture in placed.fixtures
            if fixture.belt is not None
        }
        self._depth_cameras = {
            camera.name: StereoCamera(self.simulation, camera, draws) for camera in placed.depth_cameras
        }
        self.truth = Truth(self.simulation, self.robots, placed.parts, self._belts)
        self.feed = make_feed(self.simulation, placed)
        for name, system in self.robots.items():
            if system.vacuum() is not None:
                self.feed.value(f"{prefix_of(name)}vacuum", system.suction.true_vacuum, unit="Pa")
        self.monitors = Monitors(self.simulation, self.truth.world)
        _current = weakref.ref(self)

    @classmethod
    def from_mjcf(
        cls,
        path: str | PathLike[str],
        seed: int = 0,
        *,
        robots: Mapping[str, RobotModel],
        parts: Sequence[str] = (),
        fixtures: Sequence[str] = (),
        noise: bool = True,
    ) -> Cell:
        """Return a cell from one file that contains robots and their surroundings.

        Args:
            path: of the file.
            seed, noise: as for a cell.
            robots: by their names; each read from this file, `RobotModel.from_mjcf(path, root=...)`, so that
                it stands where the file says.
            parts, fixtures: as for `Scene.from_mjcf`.
        """
        return cls(
            seed, robots=robots, scene=Scene.from_mjcf(path, parts=parts, fixtures=fixtures), noise=noise
        )

    @property
    def gripper(self) -> Gripper:
        """The first robot's gripper.

        Raises:
            BadArgument: it has none.
        """
        return next(iter(self.robots.values())).gripper

    @property
    def suction(self) -> Suction:
        """The first robot's suction cup.

        Raises:
            BadArgument: it has none.
        """
        return next(iter(self.robots.values())).suction

    @property
    def time(self) -> float:
        """Simulated time since the cell was made, s."""
        return self.simulation.time

    def belt(self, name: str | None = None) -> ConveyorBelt:
        """Return a conveyor belt by the name of its fixture; without a name, the first one.

        Raises:
            BadArgument: there is no such belt.
        """
        return _belt_of(self._belts, name)

    def depth_camera(self, name: str | None = None) -> StereoCamera:
        """Return a depth camera by its name; without a name, the first one.

        Raises:
            BadArgument: there is no such camera.
        """
        cameras = self._depth_cameras
        camera = next(iter(cameras.values()), None) if name is None else cameras.get(name)
        if camera is None:
            known = ", ".join(cameras) or "none"
            raise BadArgument(f"Expected the name of a depth camera ({known}) but got name={name!r}")
        return camera

    def wait(self, seconds: float) -> None:
        """Let simulated time pass.

        Raises:
            BadArgument: negative or not finite.
        """
        if not isinstance(seconds, (int, float)) or not math.isfinite(seconds) or seconds < 0:
            raise BadArgument(f"Expected seconds >= 0 but got seconds={seconds!r}")
        self.simulation.advance(seconds)

    def always(
        self, condition: Callable[[], object], name: str, values: MonitoredValues | None = None
    ) -> Condition:
        """Check `condition` from now on, at every control tick.

        The condition should look at `cell.truth`: a sensor read at every tick would use up its noise.

        Args:
            condition: gives something true as long as all is well.
            name: says what should hold, for the message.
            values: gives what to show when it breaks; the whole state by default.

        Raises:
            ConditionBroken: now, or from whatever lets time pass, at the tick at which it breaks.
        """
        return self.monitors.always(condition, name, values)

    def verify(self) -> None:
        """Raise the error of the first condition that broke, even if the program swallowed it then."""
        self.monitors.verify()

    def __enter__(self) -> Cell:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is None:
            self.verify()


def _belt_of(belts: Mapping[str, ConveyorBelt], name: str | None) -> ConveyorBelt:
    """Return a belt by its name, the first one without; raise BadArgument if there is none."""
    belt = next(iter(belts.values()), None) if name is None else belts.get(name)
    if belt is None:
        known = ", ".join(belts) or "none"
        raise BadArgument(f"Expected the name of a belt ({known}) but got name={name!r}")
    return belt


def prefix_of(name: str) -> str:
    """Return the prefix of all names of a robot in the physics."""
    return f"{name}/" if name else ""


def _named(robot: RobotModel | None, robots: Mapping[str, RobotModel] | None) -> Mapping[str, RobotModel]:
    """Return the robots by their names; a single robot needs none."""
    if robots is None:
        return {"": robot or gen3()}
    if robot is not None or not robots or not all(robots):
        raise BadArgument(
            f"Expected one robot, or robots={{NAME: ROBOT}} with a name each, but got robot={robot!r} and "
            f"robots={robots!r}"
        )
    return robots


def _placed(scene: Scene, draws: SeededNoise) -> tuple[Scene, dict[str, int]]:
    """Return the scene with parts placed and coloured for this round, and each part's colour number."""
    parts: list[Part] = []
    numbers: dict[str, int] = {}
    for part in scene.parts:
        x, y, z = part.position
        stream = f"placement of {part.name}"
        place = (x + draws.bounded(stream, part.jitter), y + draws.bounded(stream, part.jitter), z)
        number = draws.stream(f"colour of {part.name}").randint(1, 10)
        if part.colour is not None:
            if part.colour not in ("red", "blue"):
                raise BadArgument(f"Expected 'red' or 'blue' but got colour={part.colour!r}")
            if (number % 2 == 0) != (part.colour == "red"):
                number = number % 10 + 1
        numbers[part.name] = number
        parts.append(replace(part, position=place, colour="red" if number % 2 == 0 else "blue"))
    return replace(scene, parts=tuple(parts)), numbers


def current() -> Cell | None:
    """Return the cell made last, while it exists; else None."""
    return None if _current is None else _current()


def forget_current() -> None:
    """Forget the current cell."""
    global _current  # noqa: PLW0603  (see Cell)
    _current = None


def world() -> dict[str, float]:
    """Return the exact final state of the cell made last, flat; {} without one.

    Meant for mutabot's comparison of a mutant's world with the original's at the end of a test, not for robot
    programs.
    """
    cell = current()
    return {} if cell is None else cell.truth.world()


integrity.note(copy, daqp, hashlib, math, mujoco, np, np.linalg, ruckig)
