"""The work cell: robot, gripper, sensors, scene and time under one roof."""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable
from dataclasses import replace
from types import TracebackType

from mutabot_cell.models.kinova import gen3
from mutabot_cell.models.noise import SeededNoise
from mutabot_cell.models.robot import RobotModel
from mutabot_cell.shown.feed import tell_of

from .arm import Arm
from .errors import BadArgument
from .geometry import Pose, Position
from .gripper import Gripper
from .monitors import Condition, Monitors, Values
from .robot import Robot
from .scene import Box, Scene
from .sensors import Sensors, true_box_position, true_box_tilt
from .simulation import Simulation

_current: weakref.ref[Cell] | None = None


class Truth:
    """The cell's exact state: for tests, monitors and mutabot. A robot program has sensors instead."""

    def __init__(self, simulation: Simulation, robot: Robot, boxes: tuple[Box, ...]) -> None:
        self._simulation = simulation
        self._robot = robot
        self._stroke = 0.0 if robot.model.tool is None else robot.model.tool.effector.stroke
        self._boxes = {box.name: box for box in boxes}

    def tool_pose(self) -> Pose:
        """Exact tool pose, base frame."""
        return self._robot.tool_pose()

    def tool_position(self) -> Position:
        """Exact tool position, base frame; quicker than the whole pose."""
        return self._robot.tool_position()

    def box_position(self, name: str = "box") -> Position:
        """Exact middle of the box's bottom face, world frame."""
        return true_box_position(self._simulation, self._boxes[name])

    def box_tilt(self, name: str = "box") -> float:
        """Angle between the box's up and the world's up, degrees."""
        return true_box_tilt(self._simulation, self._boxes[name])

    def opening(self) -> float:
        """Distance between the pads, m."""
        return self._stroke - self._robot.closed_path()

    def world(self) -> dict[str, float]:
        """All of the above and the simulated time, flat: "box.x", "tool.z", "opening", "time" and so on."""
        pose = self.tool_pose()
        state = {
            "time": self._simulation.time,
            "opening": self.opening(),
            "tool.x": pose.x,
            "tool.y": pose.y,
            "tool.z": pose.z,
            "tool.theta_x": pose.theta_x,
            "tool.theta_y": pose.theta_y,
            "tool.theta_z": pose.theta_z,
        }
        for name in self._boxes:
            position = self.box_position(name)
            state |= {f"{name}.x": position.x, f"{name}.y": position.y, f"{name}.z": position.z}
            state[f"{name}.tilt"] = self.box_tilt(name)
        return state


class Cell:
    """A robot, a gripper, sensors and what stands around them, in simulated time only.

    Same seed, same commands: bit-identical run (same versions, same machine).

        with Cell(seed=3) as cell:
            cell.arm.move_by(y=0.2)
            cell.gripper.command(1.0)
            cell.wait(1.5)

    Leaving the `with` block raises a condition that broke inside and was swallowed.

    Args:
        seed: of the round; box placement, colours and sensor noise are drawn from it.
        robot: with its tool; the published experiment's Kinova Gen3 by default.
        scene: what stands around the robot; the published experiment's cell by default.
        noise: False makes all sensors exact (placement and colours are still drawn).
        grip_force: N at each pad; by default what the tool says (`Fingers.force`), 60 N for the 2F-85.
        finger_speed: m/s; likewise, 0.1 m/s.

    Attributes:
        arm, gripper, sensors: as the robot program uses them.
        truth: the exact state, for tests and monitors only.
        simulation: the clock and the physics; `simulation.tick` is the one way time advances.
        feed: what the cell tells mutabot while a test is recorded; a test may tell more by it.
    """

    def __init__(
        self,
        seed: int = 0,
        *,
        robot: RobotModel | None = None,
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
        self.simulation = Simulation(placed, {"": robot or gen3()})
        body = self.simulation.robot
        self.arm = Arm(self.simulation, body)
        if body.model.tool is not None:
            fingers = body.model.tool.effector
            self.gripper = Gripper(self.simulation, body, fingers, draws, grip_force, finger_speed)
        self.sensors = Sensors(
            self.simulation, body, self.arm.kinematics, draws, placed.boxes, numbers, placed.camera
        )
        self.truth = Truth(self.simulation, body, placed.boxes)
        self.feed = tell_of(self.simulation, body, placed)
        self.monitors = Monitors(self.simulation, self.truth.world)
        _current = weakref.ref(self)

    @property
    def time(self) -> float:
        """Simulated time since the cell was made, s."""
        return self.simulation.time

    def wait(self, seconds: float) -> None:
        """Let simulated time pass.

        Raises:
            BadArgument: negative or not finite.
        """
        if not isinstance(seconds, (int, float)) or not math.isfinite(seconds) or seconds < 0:
            raise BadArgument(f"Expected seconds >= 0 but got seconds={seconds!r}")
        self.simulation.advance(seconds)

    def always(self, condition: Callable[[], object], name: str, values: Values | None = None) -> Condition:
        """Watch `condition` from now on, at every control tick.

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
        """Raise the first condition that broke, also if its exception was swallowed when it did."""
        self.monitors.verify()

    def __enter__(self) -> Cell:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is None:
            self.verify()


def _placed(scene: Scene, draws: SeededNoise) -> tuple[Scene, dict[str, int]]:
    """The scene with boxes placed and coloured for this round, and each box's colour number."""
    boxes: list[Box] = []
    numbers: dict[str, int] = {}
    for box in scene.boxes:
        x, y, z = box.position
        stream = f"placement of {box.name}"
        place = (x + draws.bounded(stream, box.jitter), y + draws.bounded(stream, box.jitter), z)
        number = draws.stream(f"colour of {box.name}").randint(1, 10)
        if box.colour is not None:
            if box.colour not in ("red", "blue"):
                raise BadArgument(f"Expected 'red' or 'blue' but got colour={box.colour!r}")
            if (number % 2 == 0) != (box.colour == "red"):
                number = number % 10 + 1
        numbers[box.name] = number
        boxes.append(replace(box, position=place, colour="red" if number % 2 == 0 else "blue"))
    return replace(scene, boxes=tuple(boxes)), numbers


def current() -> Cell | None:
    """The cell made last, while it lives."""
    return None if _current is None else _current()


def forget_current() -> None:
    """From now on there is no current cell."""
    global _current  # noqa: PLW0603  (see Cell)
    _current = None


def world() -> dict[str, float]:
    """The exact final state of the cell made last, flat; {} without one.

    Meant for mutabot's comparison of a mutant's world with the original's at the end of a test, not for robot
    programs.
    """
    cell = current()
    return {} if cell is None else cell.truth.world()
