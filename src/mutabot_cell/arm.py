"""The arm as robot programs use it: joint moves and straight-line moves, refused or stopped if necessary."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from mutabot_cell.models.assembly import compensation_of
from mutabot_cell.models.options import PHYSICS_STEP
from mutabot_cell.models.robot import RobotModel
from mutabot_cell.motion.braking import braked, braked_joints
from mutabot_cell.motion.compliance import Push, UntilContact
from mutabot_cell.motion.feedforward import FeedForward
from mutabot_cell.motion.kinematics import Kinematics
from mutabot_cell.motion.line import Line
from mutabot_cell.motion.online import JointSteps, OnlineMotion
from mutabot_cell.motion.planning import Planner
from mutabot_cell.motion.rounded_path import RoundedPath
from mutabot_cell.motion.tracking import TrackedBelt, Tracking
from mutabot_cell.motion.trajectory import Motion

from .errors import BadArgument, MotionRefused, PathLost, ProtectiveStop
from .force_sensor import ForceSensor
from .geometry import Array, Pose, pose_of, rotation_from_euler
from .guard import Guard
from .lookahead import InputPlan, QuickCheck
from .move import Move
from .robot import Robot
from .simulation import STEPS_PER_TICK, TICK, Simulation
from .stretch import LONGEST
from .tool_path import ToolPath

MOST_FELT_SPEED = 0.05
"""Limit of motions that the force sensor decides, m/s (our choice): something as stiff as a table resists
with 40 N before an arm of this speed has come to rest."""

_RELAXING_TICKS = 20
_SETTLED = 0.001
_SETTLING_TICKS = 50


class Arm:
    """An arm with a servo per joint.

    Poses are in the base frame: m, and Euler angles x, y, z in degrees (R = Rz·Ry·Rx). Joint angles are in
    degrees.
    Every move returns when it has been carried out.

    Attributes:
        kinematics: the controller's model of the arm; it also turns encoder readings into a tool pose.
        guard: of the protective stop.
    """

    def __init__(self, simulation: Simulation, robot: Robot, force_sensor: ForceSensor) -> None:
        self._simulation = simulation
        self._robot = robot
        self._model = robot.model
        self.kinematics = Kinematics(self._model)
        self._planner = Planner(self._model, self.kinematics)
        self._setpoint: Array = np.array(self._model.home)
        self.guard = Guard(simulation, robot)
        self._stream: Array | None = None
        self._streamed = 0
        self._force_sensor = force_sensor
        self._move: Move | None = None
        self._online: OnlineMotion | None = None
        self._tracking: Tracking | None = None
        self._steps: JointSteps | None = None
        self._lost: PathLost | None = None
        self._stop: ProtectiveStop | None = None
        self._lag = robot.lag()
        self._compared: Callable[[], Array] | None = None
        fed = self._model.is_fed_forward
        self._feed_forward = FeedForward(self._model, robot.stiffness()) if fed else None
        self._flange = _flange_in_tool(self._model)
        self.set_payload(0.0)
        simulation.before_tick.append(self._drive)
        simulation.after_tick.append(self._watch)
        simulation.lookahead.plan_inputs(self._drive, InputPlan(self._write, self._keep))
        guard = self.guard
        simulation.lookahead.add_check(
            self._watch, QuickCheck(self._until, guard.note, guard.quiet, guard.passed)
        )

    def commanded_joints(self) -> tuple[float, ...]:
        """Return the setpoints of the joints, degrees, not wrapped."""
        return self._setpoint_degrees()

    def commanded_pose(self) -> Pose:
        """Return the tool pose of the setpoints, in a tracked belt's frame: relative moves start here."""
        if self._tracking is not None:
            return pose_of(*self._tracking.pose())
        position, rotation = self.kinematics.tool(self._setpoint)
        return pose_of(position, rotation)

    def home(self) -> None:
        """Move the joints to the home position; continuous joints turn the shorter way.

        Raises:
            ProtectiveStop: something was in the way.
        """
        self.start_home().wait()

    def start_home(self) -> Move:
        """Start the same move as `home`, and return at once."""
        return self._start_joints(np.array(self._model.home), 1.0)

    def move_joints(self, angles: Sequence[float], *, speed: float = 1.0) -> None:
        """Move all joints to `angles` (one each, degrees) at once, arriving together.

        Args:
            speed: part of the joints' speed limits, 0..1.

        Raises:
            BadArgument: not one finite number per joint.
            MotionRefused: an angle is beyond its joint's limit.
            ProtectiveStop: something was in the way.
        """
        self._start_angles(angles, speed).wait()

    def start_move_joints(self, angles: Sequence[float], *, speed: float = 1.0) -> Move:
        """Start the same move as `move_joints`, and return at once."""
        return self._start_angles(angles, speed)

    def _setpoint_degrees(self) -> tuple[float, ...]:
        return tuple(np.degrees(self._setpoint).tolist())

    def _start_angles(self, angles: Sequence[float], speed: float) -> Move:
        _check_numbers("angles", angles, len(self._setpoint))
        _check_speed(speed)
        return self._start_joints(np.radians(np.array(angles, dtype=float)), speed)

    def _start_joints(self, target: Array, speed: float) -> Move:
        self._check_ready()
        self._check_base()
        for index, (low, high) in enumerate(self._model.ranges):
            if math.isinf(high - low):
                turns = round((self._setpoint[index] - target[index]) / (2 * math.pi))
                target[index] += turns * 2 * math.pi
            elif not low <= target[index] <= high:
                allowed = low if target[index] < low else high
                excess = math.degrees(abs(target[index] - allowed))
                raise MotionRefused(
                    f"joint {index + 1} would go to {math.degrees(target[index]):.1f} deg, "
                    f"{excess:.1f} deg beyond its limit of {math.degrees(allowed):.1f} deg",
                    limit=f"joint {index + 1}",
                    value=math.degrees(target[index]),
                    allowed=math.degrees(allowed),
                    excess=excess,
                    unit="deg",
                )
        return self._start(self._planner.between(self._setpoint, target, speed))

    def move_to(self, pose: Pose, *, speed: float = 1.0) -> None:
        """Move the tool in a straight line to `pose`, turning evenly on the way.

        Args:
            speed: part of the tool's speed limits, 0..1. Joint limits can make the motion slower.

        Raises:
            BadArgument: a value is not a finite number.
            MotionRefused: some point of the line is out of reach or limits; nothing has moved.
            ProtectiveStop: something was in the way.
        """
        self.start_move_to(pose, speed=speed).wait()

    def start_move_to(self, pose: Pose, *, speed: float = 1.0) -> Move:
        """Start the same move as `move_to`, and return at once."""
        values = (pose.x, pose.y, pose.z, pose.theta_x, pose.theta_y, pose.theta_z)
        _check_numbers("pose", values, 6)
        _check_speed(speed)
        self._check_ready()
        tracking = self._tracking
        start, rotation = self.kinematics.tool(self._setpoint) if tracking is None else tracking.pose()
        line = Line.between(start, rotation, np.array(values[:3]), rotation_from_euler(*values[3:]))
        if line.length < 1e-7 and line.angle < 1e-7:
            return Move(self)
        if tracking is None:
            return self._start(self._planner.along(self._setpoint, line, speed))
        tracking.move(line, speed, lambda line: self.kinematics.follow(self._setpoint, line))
        self._move = Move(self)
        return self._move

    def move_by(
        self,
        x: float = 0.0,
        y: float = 0.0,
        z: float = 0.0,
        theta_x: float = 0.0,
        theta_y: float = 0.0,
        theta_z: float = 0.0,
        *,
        speed: float = 1.0,
    ) -> None:
        """Move like `move_to`, but add m (base frame) and degrees to the commanded pose's values."""
        self.start_move_by(x, y, z, theta_x, theta_y, theta_z, speed=speed).wait()

    def start_move_by(
        self,
        x: float = 0.0,
        y: float = 0.0,
        z: float = 0.0,
        theta_x: float = 0.0,
        theta_y: float = 0.0,
        theta_z: float = 0.0,
        *,
        speed: float = 1.0,
    ) -> Move:
        """Start the same move as `move_by`, and return at once."""
        _check_numbers("amounts", (x, y, z, theta_x, theta_y, theta_z), 6)
        now = self.commanded_pose()
        return self.start_move_to(
            Pose(
                now.x + x,
                now.y + y,
                now.z + z,
                now.theta_x + theta_x,
                now.theta_y + theta_y,
                now.theta_z + theta_z,
            ),
            speed=speed,
        )

    def new_path(self) -> ToolPath:
        """Return a new path for the tool, to be described point by point and travelled without a stop."""

        def where() -> Array:
            return self.kinematics.tool(self._robot.encoders())[0]

        def begin() -> tuple[Array, Array]:
            return self.kinematics.tool(self._setpoint)

        return ToolPath(begin, where, self._start_path, lambda: self._simulation.time)

    def _start_path(self, path: RoundedPath, speed: float) -> Move:
        limit = self._model.tool_limits.speed
        _check_positive("speed", speed)
        if speed > limit:
            raise BadArgument(f"Expected 0 < speed <= {limit} m/s but got speed={speed!r}")
        self._check_ready()
        self._check_base()
        return self._start(self._planner.along(self._setpoint, path, speed / limit))

    def track(self, belt: TrackedBelt, since: float | None = None) -> None:
        """Let the tool move with a belt; return when it does, to within 0.2 mm and 5 mm/s.

        From then on poses are in the belt's frame, in which a thing on the belt stays where it was when the
        encoder read `since`: straight moves go there, wherever it has got to by now. Joint moves are refused.

        Args:
            belt: to follow.
            since: encoder position, m, at which poses in the belt's frame are those in the base frame; now by
                default.

        Raises:
            MotionRefused: the belt is faster than the tool may be; nothing has moved.
            PathLost: a limit was met on the way; the arm has braked to rest and no longer tracks.
            ProtectiveStop: something was in the way.
        """
        start = belt.position() if since is None else since
        _check_numbers("since", (start,), 1)
        self._check_ready()
        self._check_base()
        pace, limit = abs(belt.speed()), self._model.tool_limits.speed
        if pace > limit:
            raise MotionRefused(
                f"the belt's {pace:.3f} m/s are {pace - limit:.3f} m/s more than the "
                f"tool's limit of {limit} m/s",
                limit="tool speed",
                value=pace,
                allowed=limit,
                excess=pace - limit,
                unit="m/s",
            )
        self._steps = JointSteps(self.kinematics, self._model, self._setpoint, STEPS_PER_TICK, PHYSICS_STEP)
        self._online = self._tracking = tracking = Tracking(
            self._steps, belt, self._robot.in_base_frame(belt.direction), start, TICK, self._model.tool_limits
        )
        self._simulation.tick()
        while not tracking.is_synchronous:
            self._simulation.tick()

    def stop_tracking(self) -> None:
        """Bring the tool to rest; return when it has stopped. Poses are in the base frame again.

        Raises:
            MotionRefused: a motion on the belt is under way.
            ProtectiveStop: something was in the way.
        """
        if self._tracking is None:
            return
        self._check_ready()
        self._tracking.end()
        while self._tracking is not None or self._lost is not None:
            self._simulation.tick()
        self._settle()

    def is_tracking(self) -> bool:
        """Return whether the arm follows a belt."""
        return self._tracking is not None

    def move_until_contact(
        self, x: float = 0.0, y: float = 0.0, z: float = 0.0, *, force: float = 5.0, speed: float = 0.02
    ) -> bool:
        """Move the tool in a straight line by at most this much, and stop it when something resists.

        The force is what the wrist's sensor reads: call its `zero` before, away from what will be touched.

        Args:
            x, y, z: m, base frame.
            force: along the way that counts as contact, N.
            speed: m/s.

        Returns:
            Whether something resisted.

        Raises:
            BadArgument: no way to go, or a value out of its range.
            MotionRefused: some point of the line is out of reach or limits; nothing has moved.
            PathLost: a limit was met on the way; the arm has braked to rest.
            ProtectiveStop: it resisted too hard.
        """
        _check_numbers("amounts", (x, y, z), 3)
        _check_positive("force", force)
        shift = np.array((x, y, z), dtype=float)
        if not shift.any():
            raise BadArgument("Expected a way to go but got x=0, y=0, z=0")
        steps = self._compliant_steps(speed)
        start, rotation = steps.tool()
        self.kinematics.follow(self._setpoint, Line(start, rotation, shift, np.zeros(3)))
        motion = UntilContact(steps, shift, speed, force, self._measured_force, TICK)
        self._begin(motion).wait()
        return motion.touched

    def push(
        self,
        *,
        x: float | None = None,
        y: float | None = None,
        z: float | None = None,
        seconds: float,
        travel: float = 0.02,
        speed: float = 0.02,
    ) -> None:
        """Push with a force for some time, by the wrist's force sensor; the tool keeps its orientation.

        Along an axis with a force, also with 0 N, the tool gives way; along one with None it keeps its place.
        Call the sensor's `zero` before, away from what will be touched.

        Args:
            x, y, z: force that the tool exerts along the base frame's axes, N.
            seconds: how long.
            travel: the motion ends sooner when the tool has gone so far, m.
            speed: at most, m/s along each axis.

        Raises:
            BadArgument: no force, or a value out of its range.
            PathLost: a limit was met on the way; the arm has braked to rest.
            ProtectiveStop: something resisted too hard.
        """
        self.start_push(x=x, y=y, z=z, seconds=seconds, travel=travel, speed=speed).wait()

    def start_push(
        self,
        *,
        x: float | None = None,
        y: float | None = None,
        z: float | None = None,
        seconds: float,
        travel: float = 0.02,
        speed: float = 0.02,
    ) -> Move:
        """Start the same motion as `push`, and return at once; to brake it ends the push."""
        forces = (x, y, z)
        if forces == (None, None, None):
            raise BadArgument("Expected a force along x, y or z but got none")
        _check_numbers("forces", [0.0 if force is None else force for force in forces], 3)
        _check_positive("seconds", seconds)
        _check_positive("travel", travel)
        steps = self._compliant_steps(speed)
        return self._begin(Push(steps, forces, speed, travel, seconds, self._measured_force, TICK))

    def _compliant_steps(self, speed: float) -> JointSteps:
        """Return the joints' steps, for a motion that the force sensor controls."""
        _check_positive("speed", speed)
        if speed > MOST_FELT_SPEED:
            raise BadArgument(f"Expected 0 < speed <= {MOST_FELT_SPEED} m/s but got speed={speed!r}")
        self._check_ready()
        self._check_base()
        self._steps = JointSteps(self.kinematics, self._model, self._setpoint, STEPS_PER_TICK, PHYSICS_STEP)
        return self._steps

    def _begin(self, motion: OnlineMotion) -> Move:
        self._online, self._move = motion, Move(self)
        return self._move

    def _measured_force(self) -> Array:
        """Return the force on the tool by the zeroed sensor: base frame, N, shape (3,)."""
        wrench = self._force_sensor.wrench()
        _, rotation = self.kinematics.tool(self._setpoint)
        felt: Array = rotation @ self._flange @ (wrench.fx, wrench.fy, wrench.fz)
        return felt

    def set_payload(self, mass: float, centre: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        """Declare what the gripper holds, so that the controller carries its weight and expects its forces.

        Without it a part is carried by the servos' stiffness alone, and a heavy one looks like a collision.

        Args:
            mass: of the part, kg.
            centre: of mass, in the tool frame, m.

        Raises:
            BadArgument: not numbers, or more than the arm is rated for (`RobotModel.payload`).
        """
        _check_numbers("payload", (mass, *centre), 4)
        rated = self._model.payload
        if not 0.0 <= mass <= rated:
            raise BadArgument(f"Expected 0 <= payload <= {rated} kg but got mass={mass!r}")
        self.guard.payload = float(mass)
        self._simulation.model.body_gravcomp[self._robot.payload] = compensation_of(mass)
        self._simulation.model.body_ipos[self._robot.payload] = centre
        if self._feed_forward is not None:
            self._feed_forward.set_payload(mass, centre)

    def acknowledge_stop(self) -> None:
        """Allow motions again after a protective stop; takes a moment until the joints stop pressing."""
        if self._stop is None:
            return
        for _ in range(_RELAXING_TICKS):
            self._setpoint = self._robot.encoders()
            self._simulation.tick()
        self._stop = None
        self.guard.pressed_ticks = 0

    def _check_ready(self) -> None:
        if self._stop is not None:
            raise MotionRefused(f"not acknowledged: {self._stop}", limit="protective stop") from self._stop

        if self._move is not None or self._lost is not None:
            raise MotionRefused("another motion is under way", limit="motion under way")

    def _check_base(self) -> None:
        if self._tracking is not None:
            raise MotionRefused("the arm tracks a belt", limit="tracking")

    def is_under_way(self, move: Move) -> bool:
        """Return whether a motion has not ended; see `Move.done`."""
        return self._move is move

    def finish(self, move: Move) -> None:
        """Wait until a motion has ended; see `Move.wait`."""
        if self._move is not move:
            return
        while self._move is move:
            self._simulation.tick(LONGEST)
        self._settle()

    def brake(self, move: Move) -> None:
        """Begin to brake a motion; see `Move.brake`."""
        if self._tracking is not None:
            self._tracking.stop_move()
        elif isinstance(self._online, Push):
            self._online.stop()
        elif self._move is move and self._streamed:
            self._load(braked(self._motion, self._streamed, PHYSICS_STEP, self._model.limits))
        elif self._move is move:  # nothing of it has been carried out
            self._stream = self._move = None

    def _start(self, motion: Motion) -> Move:
        move = Move(self)
        if len(motion.joints):
            self._load(motion)
            self._move = move
        return move

    def _load(self, motion: Motion) -> None:
        stream, joints = motion.joints + self._lag * motion.speeds, motion.joints
        if self._feed_forward is not None:
            stream += self._feed_forward.offsets(motion, PHYSICS_STEP)
        rest = -len(joints) % STEPS_PER_TICK
        if rest:
            still = np.repeat(joints[-1:], rest, axis=0)
            stream, joints = np.concatenate((stream, still)), np.concatenate((joints, still))
        self._stream, self._motion_joints = stream, joints
        self._streamed = 0
        self._motion = motion

    def _settle(self) -> None:
        for _ in range(_SETTLING_TICKS):
            if float(np.abs(self._following_error()).max()) < _SETTLED:
                break
            self._simulation.tick()

    def _ask(self, online: OnlineMotion) -> None:
        """Load the setpoints of an online motion for the coming tick."""
        try:
            motion = online.tick()
        except PathLost as lost:
            self._lost = lost
            self._online = self._tracking = None
            steps = self._steps
            if steps is not None:
                self._load(braked_joints(steps, PHYSICS_STEP, self._model.limits))
            return
        if motion is None:
            self._online = self._tracking = self._move = None
            return
        self._load(motion)
        if self._tracking is not None and not self._tracking.is_moving:
            self._move = None

    def _drive(self) -> None:
        setpoints = self._simulation.setpoints[:, self._robot.servos]
        # a servo brings its encoder to the setpoint, so the joint to where the encoder reads that
        error = self._robot.encoder_error
        if self._stream is None and self._online is not None:
            self._ask(self._online)
        if self._stream is None:
            setpoints[:] = self._setpoint - error
            return
        end = self._streamed + STEPS_PER_TICK
        np.subtract(self._stream[self._streamed : end], error, out=setpoints)
        self._setpoint = self._motion_joints[end - 1]
        self._streamed = end
        if end >= len(self._stream):
            self._stream = None
            if self._online is None:
                self._move = None

    def _write(self, inputs: Array) -> int:
        """Write the setpoints of the coming ticks, as `_drive` does for one."""
        if self._online is not None:
            return 1
        error, wanted = self._robot.encoder_error, inputs[:, :, self._robot.servos]
        if self._stream is None:
            wanted[:] = self._setpoint - error
            self.guard.planned[:] = self._setpoint - error
            return len(inputs)
        start = self._streamed
        ticks = min(len(inputs), (len(self._stream) - start) // STEPS_PER_TICK)
        end = start + ticks * STEPS_PER_TICK
        stream = self._stream[start:end].reshape(ticks, STEPS_PER_TICK, -1)
        np.subtract(stream, error, out=wanted[:ticks])
        ends = self._motion_joints[start + STEPS_PER_TICK - 1 : end : STEPS_PER_TICK]
        np.subtract(ends, error, out=self.guard.planned[:ticks])
        return ticks

    def _keep(self, ticks: int) -> None:
        if self._stream is None:
            return
        self._streamed += ticks * STEPS_PER_TICK
        self._setpoint = self._motion_joints[self._streamed - 1]
        if self._streamed >= len(self._stream):
            self._stream = self._move = None

    @property
    def setpoint(self) -> Array:
        """The planned present encoder readings, shape (joints,), rad."""
        return self._setpoint

    def compare_with(self, setpoints: Callable[[], Array]) -> None:
        """Let the protective stop compare encoders with other setpoints than planned, such as later ones.

        Args:
            setpoints: gives what the encoders should read, shape (joints,), rad.
        """
        self._compared = setpoints

    def _following_error(self) -> Array:
        wanted = self._setpoint if self._compared is None else self._compared()
        error: Array = wanted - self._robot.encoders()
        return error

    def _watch(self) -> None:
        """Stop after a tick if the guard demands it."""
        stop = self.guard.overload(self._following_error)
        if self._stop is not None:
            return
        if stop is None and self._lost is not None and self._stream is None:
            lost, self._lost = self._lost, None
            raise lost
        stop = stop or self.guard.collision(self._following_error())
        if stop is not None:
            raise self._stopped(stop)

    def _until(self) -> int:
        self.guard.begin_stretch()
        decides = self.guard.pressed_ticks or self._stop is not None or self._lost is not None
        return 1 if decides else LONGEST

    def _stopped(self, stop: ProtectiveStop) -> ProtectiveStop:
        self._stop = stop
        self._stream = self._online = self._tracking = self._move = self._lost = None
        self._setpoint = self._robot.encoders()
        return stop


def _check_numbers(name: str, values: Sequence[float], count: int) -> None:
    fine = len(values) == count and all(
        isinstance(value, (int, float, np.floating)) and not isinstance(value, bool) and math.isfinite(value)
        for value in values
    )
    if not fine:
        raise BadArgument(f"Expected {count} finite numbers but got {name}={values!r}")


def _check_positive(name: str, value: float) -> None:
    _check_numbers(name, (value,), 1)
    if value <= 0.0:
        raise BadArgument(f"Expected {name} > 0 but got {name}={value!r}")


def _flange_in_tool(robot: RobotModel) -> Array:
    """Return the rotation, shape (3, 3), from the flange's frame, in which forces are read, to the tool's."""
    if robot.tool is None:
        return np.eye(3)
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, np.array(robot.tool.turn))
    return turned.reshape(3, 3).T


def _check_speed(speed: float) -> None:
    if not (isinstance(speed, (int, float)) and 0.0 < speed <= 1.0):
        raise BadArgument(f"Expected 0 < speed <= 1 but got speed={speed!r}")
