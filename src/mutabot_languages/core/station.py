"""The border to the simulated cell: poses, motions and signals of a program become calls of the cell's own.

Every call is made in ``Station.call``, whose frame says which part of the program makes it.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from mutabot_languages.errors import UnreachableError, UnsupportedError

from .frames import IDENTITY, Frame, cross, vector_of
from .inverse import joint_target
from .signals import CellMap, InputReader, signal_name

T = TypeVar("T")
TICK = 0.01
#: a motion: the method of the cell's arm, its arguments, and a part of its speed
ArmMotion = tuple[str, tuple[Any, ...], float]
#: segments of a full circle
_SEGMENTS = 48


class ProgramPlace:
    """The part of a program that is being carried out.

    Attributes:
        file: where it stands.
        extent: its place in it.
        routine: what it belongs to.
        shown: how it begins.
    """

    __slots__ = ("extent", "file", "routine", "shown")

    def __init__(self, file: str, extent: tuple[int, int, int, int], routine: str, shown: str) -> None:
        self.file, self.extent, self.routine, self.shown = file, extent, routine, shown

    @property
    def text(self) -> str:
        """File and line, for messages."""
        return f"{Path(self.file).name}:{self.extent[0]}"


class Station:
    """A cell as programs see it.

    Args:
        cell: a ``mutabot_cell.Cell``.
        signals: what its signals are.
        inputs: values of inputs, or functions that give them, which go before the map.

    Attributes:
        tool: the program's tool on its flange.
        errors: those of the cell, which are no errors of a program.
        outputs: the last value of each output.
        notes: what was accepted without an effect, each once.
    """

    def __init__(self, cell: Any, signals: CellMap, inputs: Mapping[str, Any]) -> None:
        self.cell = cell
        package = sys.modules[type(cell).__module__.partition(".")[0]]
        self.errors: tuple[type[Exception], ...] = getattr(package, "CellError", ())
        self._map = signals
        self._inputs = {signal_name(name): value for name, value in inputs.items()}
        x, y, z, *angles = signals.tool
        self._mounted = Frame.of_euler((x, y, z), angles[2], angles[1], angles[0])
        self._pose_type: Any = type(cell.truth.tool_pose())
        system = next(iter(cell.robots.values()))
        self.model: Any = system.robot.model
        self.tool = IDENTITY
        self.outputs: dict[str, Any] = {}
        self.notes: dict[str, None] = {}

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return float(self.cell.time)

    @property
    def joints(self) -> int:
        """How many the arm has."""
        return len(self.model.home)

    def call(self, site: ProgramPlace, function: Callable[..., T], *arguments: Any, **named: Any) -> T:
        """Call something of the cell for a part of the program. The front end looks for this frame."""
        try:
            return function(*arguments, **named)
        except self.errors as error:
            if not isinstance(error, AssertionError):  # of a test's condition
                error.args = (f"{site.text}: {site.shown}: {error} (in {site.routine})",)
            raise

    def note(self, text: str) -> None:
        """Note what has no effect here."""
        self.notes[text] = None

    # poses

    def to_cell(self, target: Frame) -> Frame:
        """Return the cell's pose that brings the program's tool point to ``target``, robot base frame."""
        return target * self.tool.inverse() * self._mounted

    def to_program(self, pose: Any) -> Frame:
        """Return the pose of the program's tool point, robot base frame, of a pose of the cell."""
        at = Frame.of_euler((pose.x, pose.y, pose.z), pose.theta_z, pose.theta_y, pose.theta_x)
        return at * self._mounted.inverse() * self.tool

    def actual(self, site: ProgramPlace) -> Frame:
        """Return where the program's tool point is by the encoders, robot base frame."""
        return self.to_program(self.call(site, self.cell.sensors.tool_pose))

    def commanded(self, site: ProgramPlace) -> Frame:
        """Return where the program's tool point is meant to be, robot base frame."""
        return self.to_program(self.call(site, self.cell.arm.commanded_pose))

    def angles(self, site: ProgramPlace) -> list[float]:
        """Return joint angles by the encoders, degrees."""
        return [float(angle) for angle in self.call(site, self.cell.sensors.joint_angles)]

    def forward(self, degrees: list[float]) -> Frame:
        """Return where the program's tool point is with these joint angles, robot base frame."""
        degrees = self._all_joints(degrees)
        position, rotation = self.cell.arm.kinematics.tool([math.radians(angle) for angle in degrees])
        return matrix_frame(position.tolist(), rotation.tolist()) * self._mounted.inverse() * self.tool

    def inverse(self, target: Frame, near: list[float] | None = None) -> list[float]:
        """Return the joint angles, degrees, for a pose of the program's tool point, nearest to others.

        Raises UnreachableError if it cannot be reached.
        """
        arm = self.cell.arm
        start = [math.degrees(angle) for angle in arm.setpoint] if near is None else near
        pose = self.to_cell(target)
        found = joint_target(arm.kinematics, self.model, pose, start)
        if found is None:
            x, y, z = target.position
            is_limit = joint_target(arm.kinematics, self.model, pose, start, is_limited=False) is not None
            raise UnreachableError(
                f"unreachable: no joint angles {'within the limits ' if is_limit else ''}bring the tool to "
                f"({x:.4f}, {y:.4f}, {z:.4f}) m as it is turned",
                is_limit=is_limit,
            )
        return found

    # motions: each returns the function of the cell and its arguments

    def line(self, target: Frame, speed: float) -> ArmMotion:
        """Return a straight motion of the tool point to a pose, at a speed in m/s."""
        at = self.to_cell(target)
        # to 0.0001 degrees: programs write π with six digits, and what is left of a zero angle is no angle
        z, y, x = (round(angle, 4) + 0.0 for angle in at.euler())  # and no -0.0
        pose = self._pose_type(*at.position, x, y, z)
        return "move_to", (pose,), _part(speed / self.model.tool_limits.speed)

    def joint_move(self, angles: list[float], part: float) -> ArmMotion:
        """Return a motion of all joints to angles in degrees, at a part of their speed."""
        return "move_joints", (tuple(self._all_joints(angles)),), _part(part)

    def joint_move_to(self, target: Frame, part: float) -> ArmMotion:
        """Return a motion of all joints to a pose, at a part of their speed.

        Where no joint angles reach it, a straight one, whose refusal the cell words: a refusal is a call's.
        """
        try:
            return self.joint_move(self.inverse(target), part)
        except UnreachableError as error:
            self.note(f"{error}: the cell was asked for a straight motion")
            return self.line(target, part * float(self.model.tool_limits.speed))

    def _all_joints(self, angles: list[float]) -> list[float]:
        """Return angles of all joints, degrees; those that the program's robot lacks stay."""
        now = [math.degrees(angle) for angle in self.cell.arm.setpoint]
        return [*angles, *now[len(angles) :]][: self.joints]

    def arc(self, start: Frame, via: Frame, end: Frame, speed: float) -> list[ArmMotion]:
        """Return a circular motion through ``via``, in short straight ones."""
        return [self.line(point, speed) for point in arc_points(start, via, end)]

    # signals

    def write(self, site: ProgramPlace, name: str, value: Any) -> None:
        """Set an output."""
        key = signal_name(name)
        self.outputs[key] = value
        entry = self._map.outputs.get(key)
        if entry is None:
            self.note(f"the output {name} is connected to nothing in the cell")
            return
        self.drive(site, entry, is_on=bool(value))
        if "belt" in entry:
            belt = self.cell.belt(entry["belt"] or None)
            self.call(site, belt.run, float(entry.get("speed", 0.1)) * float(value))

    def read(self, site: ProgramPlace, name: str) -> Any:
        """Read an input. Raises UnsupportedError if nothing says what it is."""
        key = signal_name(name)
        if key in self._inputs:
            found = self._inputs[key]
            return self.call(site, found) if callable(found) else found
        entry = self._map.inputs.get(key)
        if entry is None:
            raise UnsupportedError(
                f"{site.text}: nothing says what {name} is: load the file that declares it; if it is an "
                f'input, name it in the cell map ([in."{name}"]) or in run(cell, inputs={{…}})'
            )
        return self._reader(site, entry)()

    def knows_input(self, name: str) -> bool:
        """Return whether something says what an input is."""
        key = signal_name(name)
        return key in self._inputs or key in self._map.inputs

    def _reader(self, site: ProgramPlace, entry: Mapping[str, Any]) -> InputReader:
        sensors, call = self.cell.sensors, self.call
        if "light_barrier" in entry:
            name = entry["light_barrier"] or None
            return lambda: call(site, sensors.light_barriers.is_interrupted, name)
        if "holding" in entry:
            return lambda: call(site, self.cell.gripper.holding) is bool(entry["holding"])
        if "colour" in entry:
            return lambda: call(site, sensors.colour) == entry["colour"]
        if "nearer" in entry:
            return lambda: call(site, sensors.distance) < entry["nearer"]
        if "distance" in entry:
            return lambda: call(site, sensors.distance) * float(entry["distance"])
        if "opening" in entry:
            return lambda: call(site, self.cell.gripper.opening) > entry["opening"]
        if "output" in entry:
            return lambda: self.outputs.get(signal_name(entry["output"]), False)
        return lambda: entry.get("constant", False)

    def function(self, name: str) -> Mapping[str, Any] | None:
        """Return what the cell map says of a function; None if nothing."""
        return self._map.functions.get(signal_name(name))

    def drive(self, site: ProgramPlace, entry: Mapping[str, Any], *, is_on: bool) -> None:
        """Let gripper and suction do what an entry of the cell map says, of an output or of a function."""
        if "force" in entry:
            self.call(site, self.cell.gripper.set_force, float(entry["force"]))
        if "gripper" in entry:
            controls = entry["gripper"]
            position = controls[int(is_on)] if isinstance(controls, list) else controls if is_on else None
            if position is not None and position >= 0:
                self.call(site, self.cell.gripper.command, position)
        if "suction" in entry:
            suction = self.cell.suction
            self.call(site, suction.on if is_on == bool(entry["suction"]) else suction.off)


def matrix_frame(position: Sequence[float], rotation: Sequence[Sequence[float]]) -> Frame:
    """Return the frame of a position and a rotation matrix, shape (3, 3)."""
    (a, b, c), (d, e, f), (g, h, i) = rotation
    candidates = (
        (1 + a + e + i, (1 + a + e + i, h - f, c - g, d - b)),
        (1 + a - e - i, (h - f, 1 + a - e - i, b + d, c + g)),
        (1 - a + e - i, (c - g, b + d, 1 - a + e - i, f + h)),
        (1 - a - e + i, (d - b, c + g, f + h, 1 - a - e + i)),
    )
    return Frame.of_quaternion(position, max(candidates)[1])


def arc_points(start: Frame, via: Frame, end: Frame) -> list[Frame]:
    """Return points of the circle through three, without the start; of a straight line, its two ends.

    The orientation turns evenly from the start's to the end's.
    """
    a, b, c = start.position, via.position, end.position
    u, w = _minus(b, a), _minus(c, a)
    normal = cross(u, w)
    area = math.hypot(*normal)
    if area < 1e-9:
        return [via, end]
    # the centre from the start: ((|u|² w - |w|² u) × (u × w)) / (2 |u × w|²)
    uu, ww = _dot(u, u), _dot(w, w)
    mixed = tuple(uu * q - ww * p for p, q in zip(u, w, strict=True))
    to_centre = tuple(number / (2 * area * area) for number in cross(mixed, normal))
    centre = tuple(p + q for p, q in zip(a, to_centre, strict=True))
    axis = tuple(number / area for number in normal)
    radius = _minus(a, centre)
    side = cross(axis, radius)
    last = _minus(c, centre)
    angle = math.atan2(_dot(last, side), _dot(last, radius)) % (2 * math.pi)
    count = max(2, math.ceil(angle / (2 * math.pi) * _SEGMENTS))
    points = []
    for index in range(1, count + 1):
        part = index / count
        turned = start.between(end, part).rotation
        cos, sin = math.cos(angle * part), math.sin(angle * part)
        place = tuple(o + cos * p + sin * q for o, p, q in zip(centre, radius, side, strict=True))
        points.append(Frame(vector_of(place), turned))
    return [*points[:-1], end]


def _minus(a: Any, b: Any) -> tuple[float, ...]:
    return tuple(p - q for p, q in zip(a, b, strict=True))


def _dot(a: Any, b: Any) -> float:
    return float(sum(p * q for p, q in zip(a, b, strict=True)))


def _part(part: float) -> float:
    """Return a part of a limit as the cell takes it."""
    return min(1.0, max(0.005, part))
