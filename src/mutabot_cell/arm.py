"""The arm as its user knows it: joint moves and straight-line moves, refused or stopped when they must be."""

from __future__ import annotations

import math
import operator
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
from mutabot_cell.motion.tracking import TrackedBelt, Tracking
from mutabot_cell.motion.trajectory import Motion, joint_motion, line_motion

from .errors import BadArgument, MotionRefused, PathLost, ProtectiveStop
from .force_sensor import ForceSensor
from .foresight import Glance, InputPlan
from .geometry import Array, Pose, pose_of, rotation_from_euler
from .move import Move
from .robot import Robot
from .simulation import STEPS_PER_TICK, TICK, Simulation
from .stretch import LONGEST, Stretch

WARMING_TIME = 30.0
"""In this time a joint warms up by two thirds of what its torque makes of it in the end, s (our choice)."""
MOST_FELT_SPEED = 0.05
"""Limit of motions that the force sensor decides, m/s (our choice): something as stiff as a table resists
with 40 N before an arm of this speed has come to rest."""

_WARMING_TICKS = 10
_RELAXING_TICKS = 20
_SURELY = 1.0 - 1e-9
"""What is below a limit by this factor is below it however it is rounded."""
_SETTLED = 0.001
_SETTLING_TICKS = 50


class Arm:
    """An arm with a servo per joint.

    Poses are in the base frame: m, and Euler angles x, y, z in degrees (R = Rz·Ry·Rx). Joint angles are in
    degrees.
    Every move returns when it has been carried out.

    Attributes:
        kinematics: the controller's model of the arm; it also turns encoder readings into a tool pose.
        explained: what else than contacts acts on the tool, as a torque on each joint, shape (joints,), Nm.
    """

    def __init__(self, simulation: Simulation, robot: Robot, force_sensor: ForceSensor) -> None:
        self._simulation = simulation
        self._robot = robot
        self._model, limits = robot.model, robot.model.limits
        self.kinematics = Kinematics(self._model)
        self._setpoint: Array = np.array(self._model.home)
        self.explained: list[Callable[[], Array]] = []
        self._stream: Array | None = None
        self._streamed = 0
        self._force_sensor = force_sensor
        self._move: Move | None = None
        self._online: OnlineMotion | None = None
        self._tracking: Tracking | None = None
        self._steps: JointSteps | None = None
        self._lost: PathLost | None = None
        self._pressed_ticks = 0
        self._first_contact = ("", "", 0.0)
        self._stop: ProtectiveStop | None = None
        self._lag = robot.lag()
        fed = self._model.is_fed_forward
        self._feed_forward = FeedForward(self._model, robot.stiffness()) if fed else None
        self._flange = _flange_in_tool(self._model)
        self._torque_limit = np.array(limits.external_torque)
        self._lowest_torque_limit, self._following_limit = min(limits.external_torque), limits.following_error
        self._payload = 0.0
        self._heat = np.zeros(len(self._setpoint))
        self._continuous = np.array(limits.torque)
        # views of the physics' own memory
        self._constraints: Array = simulation.data.qfrc_constraint[robot.dofs]
        self._motors = simulation.data.qfrc_actuator[robot.dofs]
        # of each tick of a stretch: where the joints should be at its end, what pushed them, what they gave
        self._planned, self._pushes, self._loads = np.zeros((3, LONGEST, len(self._setpoint)))
        self._heats: list[tuple[int, Array]] = []
        self.set_payload(0.0)
        simulation.before_tick.append(self._drive)
        simulation.after_tick.append(self._guard)
        simulation.foresight.drives(self._drive, InputPlan(self._write, self._keep))
        simulation.foresight.checks(self._guard, Glance(self._until, self._note, self._quiet, self._warm_in))

    def commanded_joints(self) -> tuple[float, ...]:
        """Setpoints of the joints, degrees, not wrapped."""
        return self._setpoint_degrees()

    def commanded_pose(self) -> Pose:
        """Tool pose that the setpoints stand for, in a tracked belt's frame: relative moves start here."""
        if self._tracking is not None:
            return pose_of(*self._tracking.pose())
        position, rotation = self.kinematics.tool(self._setpoint)
        return pose_of(position, rotation)

    def home(self) -> None:
        """Joint move to the home position; continuous joints turn the shorter way.

        Raises:
            ProtectiveStop: something was in the way.
        """
        self.start_home().wait()

    def start_home(self) -> Move:
        """Like `home`, but returns at once."""
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
        """Like `move_joints`, but returns at once."""
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
                    f"motion refused: joint {index + 1} would go to {math.degrees(target[index]):.1f} deg, "
                    f"{excess:.1f} deg beyond its limit of {math.degrees(allowed):.1f} deg",
                    limit=f"joint {index + 1}",
                    value=math.degrees(target[index]),
                    allowed=math.degrees(allowed),
                    excess=excess,
                    unit="deg",
                )
        return self._start(joint_motion(self._setpoint, target, PHYSICS_STEP, self._model.limits, speed))

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
        """Like `move_to`, but returns at once."""
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
            knots = self.kinematics.follow(self._setpoint, line)
            lengths, limits = (line.length, line.angle), (self._model.limits, self._model.tool_limits)
            return self._start(line_motion(knots, *lengths, PHYSICS_STEP, *limits, speed))
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
        """Like `move_to`, relative: m (base frame) and degrees are added to the commanded pose's values."""
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
        """Like `move_by`, but returns at once."""
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

    def track(self, belt: TrackedBelt, since: float | None = None) -> None:
        """Let the tool move with a belt; returns when it does, to within 0.2 mm and 5 mm/s.

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
                f"motion refused: the belt's {pace:.3f} m/s are {pace - limit:.3f} m/s more than the "
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
        """Bring the tool to rest; returns when it stands. Poses are in the base frame again.

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
        """Whether the arm follows a belt."""
        return self._tracking is not None

    def move_until_contact(
        self, x: float = 0.0, y: float = 0.0, z: float = 0.0, *, force: float = 5.0, speed: float = 0.02
    ) -> bool:
        """Move the tool in a straight line by at most this much, until something resists; it stops there.

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
        steps = self._steered(speed)
        start, rotation = steps.tool()
        self.kinematics.follow(self._setpoint, Line(start, rotation, shift, np.zeros(3)))
        motion = UntilContact(steps, shift, speed, force, self._felt, TICK)
        self._carry_out(motion)
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
        forces = (x, y, z)
        if forces == (None, None, None):
            raise BadArgument("Expected a force along x, y or z but got none")
        _check_numbers("forces", [0.0 if force is None else force for force in forces], 3)
        _check_positive("seconds", seconds)
        _check_positive("travel", travel)
        self._carry_out(Push(self._steered(speed), forces, speed, travel, seconds, self._felt, TICK))

    def _steered(self, speed: float) -> JointSteps:
        """The joints, for a motion that the force sensor decides."""
        _check_positive("speed", speed)
        if speed > MOST_FELT_SPEED:
            raise BadArgument(f"Expected 0 < speed <= {MOST_FELT_SPEED} m/s but got speed={speed!r}")
        self._check_ready()
        self._check_base()
        self._steps = JointSteps(self.kinematics, self._model, self._setpoint, STEPS_PER_TICK, PHYSICS_STEP)
        return self._steps

    def _carry_out(self, motion: OnlineMotion) -> None:
        self._online, self._move = motion, Move(self)
        self._move.wait()

    def _felt(self) -> Array:
        """What the surroundings exert on the tool by the zeroed sensor: base frame, N, shape (3,)."""
        wrench = self._force_sensor.wrench()
        _, rotation = self.kinematics.tool(self._setpoint)
        felt: Array = rotation @ self._flange @ (wrench.fx, wrench.fy, wrench.fz)
        return felt

    def set_payload(self, mass: float, centre: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        """Tell the controller what the gripper holds, so that it carries the weight and expects the forces.

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
        self._payload = float(mass)
        self._simulation.model.body_gravcomp[self._robot.payload] = compensation_of(self._payload)
        self._simulation.model.body_ipos[self._robot.payload] = centre
        if self._feed_forward is not None:
            self._feed_forward.set_payload(self._payload, centre)

    def acknowledge_stop(self) -> None:
        """Allow motions again after a protective stop; takes a moment in which the joints stop pressing."""
        if self._stop is None:
            return
        for _ in range(_RELAXING_TICKS):
            self._setpoint = self._robot.encoders()
            self._simulation.tick()
        self._stop = None
        self._pressed_ticks = 0

    def _check_ready(self) -> None:
        if self._stop is not None:
            raise MotionRefused(
                f"motion refused: not acknowledged: {self._stop}", limit="protective stop"
            ) from self._stop

        if self._move is not None or self._lost is not None:
            raise MotionRefused("motion refused: another one is under way", limit="motion under way")

    def _check_base(self) -> None:
        if self._tracking is not None:
            raise MotionRefused("motion refused: the arm tracks a belt", limit="tracking")

    def is_under_way(self, move: Move) -> bool:
        """Whether this motion has not ended; see `Move.done`."""
        return self._move is move

    def finish(self, move: Move) -> None:
        """See `Move.wait`."""
        if self._move is not move:
            return
        while self._move is move:
            self._simulation.tick(LONGEST)
        self._settle()

    def brake(self, move: Move) -> None:
        """See `Move.stop`."""
        if self._tracking is not None:
            self._tracking.stop_move()
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
        """Load what an online motion wants in the coming tick."""
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
        """`_drive`, for the coming ticks."""
        if self._online is not None:
            return 1
        error, wanted = self._robot.encoder_error, inputs[:, :, self._robot.servos]
        if self._stream is None:
            wanted[:] = self._setpoint - error
            self._planned[:] = self._setpoint - error
            return len(inputs)
        start = self._streamed
        ticks = min(len(inputs), (len(self._stream) - start) // STEPS_PER_TICK)
        end = start + ticks * STEPS_PER_TICK
        stream = self._stream[start:end].reshape(ticks, STEPS_PER_TICK, -1)
        np.subtract(stream, error, out=wanted[:ticks])
        ends = self._motion_joints[start + STEPS_PER_TICK - 1 : end : STEPS_PER_TICK]
        np.subtract(ends, error, out=self._planned[:ticks])
        return ticks

    def _keep(self, ticks: int) -> None:
        if self._stream is None:
            return
        self._streamed += ticks * STEPS_PER_TICK
        self._setpoint = self._motion_joints[self._streamed - 1]
        if self._streamed >= len(self._stream):
            self._stream = self._move = None

    def _following_error(self) -> Array:
        error: Array = self._setpoint - self._robot.encoders()
        return error

    def _guard(self) -> None:
        """Protective stop: the check that the arm's controller makes at every tick."""
        if self._simulation.ticks % _WARMING_TICKS == 0:
            self._warm()
        if self._stop is not None:
            return
        if self._lost is not None and self._stream is None:
            lost, self._lost = self._lost, None
            raise lost
        external, error = self._external(), self._following_error()
        # this runs at every tick, and nearly always the lengths are below the lowest limits of their parts
        if (
            external.dot(external) <= self._lowest_torque_limit**2
            and error.dot(error) <= self._following_limit**2
        ):
            self._pressed_ticks = 0
            return
        pressed = any(map(operator.gt, map(abs, external.tolist()), self._model.limits.external_torque))
        self._pressed_ticks = self._pressed_ticks + 1 if pressed else 0
        if pressed and self._pressed_ticks == 1:
            self._first_contact = strongest_contact(self._simulation, self._robot)
        lagging = max(map(abs, error.tolist())) > self._following_limit
        if self._pressed_ticks < 2 and not lagging:
            return
        joint = int(np.argmax(np.abs(external) / self._torque_limit if pressed else np.abs(error)))
        contacts = [strongest_contact(self._simulation, self._robot)]
        if pressed:
            contacts.append(self._first_contact)
        first, second, force = max(contacts, key=lambda contact: contact[2])
        raise self._stopped(
            ProtectiveStop(
                time=self._simulation.time,
                first=first,
                second=second,
                force=force,
                joint=joint + 1,
                torque=float(external[joint]),
                following_error=float(error[joint]),
            )
        )

    def _until(self) -> int:
        decides = self._pressed_ticks or self._stop is not None or self._lost is not None
        return 1 if decides else LONGEST

    def _note(self, number: int) -> None:
        self._pushes[number] = self._external()
        self._loads[number] = self._motors

    def _quiet(self, stretch: Stretch, known: int, ticks: int) -> int:
        pushes = (self._pushes[known:ticks] / self._torque_limit).ravel()
        errors = (self._planned[known:ticks] - stretch.places[known:ticks, self._robot.joints]).ravel()
        # mostly even the lengths of all together are below the limits of their parts; not so if one is NaN
        if not (pushes.dot(pushes) < 1.0 and errors.dot(errors) < self._following_limit**2):
            fine = (np.abs(pushes) < _SURELY) & (np.abs(errors) < _SURELY * self._following_limit)
            ticks = min([ticks, *(known + np.flatnonzero(~fine) // len(self._setpoint)).tolist()])
        # another arm may have been quiet for less long
        self._heats = [(number, heat) for number, heat in self._heats if number < known]
        heat = self._heats[-1][1] if self._heats else self._heat
        for number in range(known, ticks):
            if (self._simulation.ticks + 1 + number) % _WARMING_TICKS:
                continue
            heat = self._warmer(heat, self._loads[number])
            if not self._is_cool(heat):
                return number
            self._heats.append((number, heat))
        return ticks

    def _warm_in(self, stretch: Stretch, ticks: int) -> None:
        """`_warm`, for ticks of a stretch."""
        self._heat = next((heat for number, heat in reversed(self._heats) if number < ticks), self._heat)

    def _warmer(self, heat: Array, torques: Array) -> Array:
        """How warm the motors are when these torques have lasted for `_WARMING_TICKS`."""
        share = _WARMING_TICKS * TICK / WARMING_TIME
        warmer: Array = heat + share * ((torques / self._continuous) ** 2 - heat)
        return warmer

    @staticmethod
    def _is_cool(heat: Array) -> bool:
        return bool(heat.dot(heat) <= 1.0 or heat.max() <= 1.0)

    def _stopped(self, stop: ProtectiveStop) -> ProtectiveStop:
        self._stop = stop
        self._stream = self._online = self._tracking = self._move = self._lost = None
        self._setpoint = self._robot.encoders()
        return stop

    def _external(self) -> Array:
        """Torque on each joint that motors, friction, the arm and its declared payload do not explain, Nm."""
        torque = self._constraints
        for explain in self.explained:
            torque = torque + explain()
        if self._simulation.data.nf:
            torque = torque - self._friction()
        if self._payload:
            torque = torque - self._payload_torque()
        return torque

    def _friction(self) -> Array:
        """Torque on each joint from dry friction in it, which MuJoCo counts among the constraints, Nm."""
        data = self._simulation.data
        torque = np.zeros(len(self._setpoint))
        for row in range(data.ne, data.ne + data.nf):  # rows of friction follow those of equalities
            joint = int(data.efc_id[row]) - self._robot.dofs.start
            of_joint = data.efc_type[row] == mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF
            if of_joint and 0 <= joint < len(torque):
                torque[joint] = data.efc_force[row]
        return torque

    def _payload_torque(self) -> Array:
        """Torque on each joint from the payload's weight and inertia, Nm."""
        cell_model, data = self._simulation.model, self._simulation.data
        mujoco.mj_rnePostConstraint(cell_model, data)
        # acceleration minus gravity of the payload's centre of mass, as an accelerometer there would read it
        felt = np.zeros(6)
        mujoco.mj_objectAcceleration(cell_model, data, mujoco.mjtObj.mjOBJ_BODY, self._robot.payload, felt, 0)
        moves = np.zeros((3, cell_model.nv))
        mujoco.mj_jacBodyCom(cell_model, data, moves, None, self._robot.payload)
        torque: Array = np.dot(-self._payload * felt[3:], moves[:, self._robot.dofs])
        return torque

    def _warm(self) -> None:
        """Let the motors warm up with the square of their torque; stop when one is too warm."""
        self._heat = self._warmer(self._heat, self._motors)
        if self._stop is not None or self._is_cool(self._heat):
            return
        joint = int(np.argmax(self._heat))
        raise self._stopped(
            ProtectiveStop(
                time=self._simulation.time,
                first="",
                second="",
                force=0.0,
                joint=joint + 1,
                torque=float(self._motors[joint]),
                following_error=float(self._following_error()[joint]),
                overload=float(self._continuous[joint]),
            )
        )


def strongest_contact(simulation: Simulation, robot: Robot) -> tuple[str, str, float]:
    """The robot's part, what it touches, and the normal force (N) of the robot's strongest contact.

    A box between the fingers counts as the robot's part; ("", "", 0.0) without a contact.
    """
    cell_model, data = simulation.model, simulation.data
    body = int(cell_model.body_rootid[robot.body])
    found: tuple[str, str, float] = ("", "", 0.0)
    wrench = np.zeros(6)
    for index in range(data.ncon):
        geoms = [int(geom) for geom in data.contact[index].geom]
        roots = [int(cell_model.body_rootid[cell_model.geom_bodyid[geom]]) for geom in geoms]
        if body not in roots:
            continue
        if roots[1] == body and roots[0] != body:
            geoms.reverse()
        mujoco.mj_contactForce(cell_model, data, index, wrench)
        if abs(wrench[0]) > found[2]:
            found = (_name(cell_model, geoms[0]), _name(cell_model, geoms[1]), abs(float(wrench[0])))
    return found


def _name(model: mujoco.MjModel, geom: int) -> str:
    """Of a shape; files often name bodies only."""
    return str(model.geom(geom).name or model.body(int(model.geom_bodyid[geom])).name)


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
    """Rotation matrix, shape (3, 3), of the flange's frame, in which forces are read, in the tool's frame."""
    if robot.tool is None:
        return np.eye(3)
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, np.array(robot.tool.turn))
    return turned.reshape(3, 3).T


def _check_speed(speed: float) -> None:
    if not (isinstance(speed, (int, float)) and 0.0 < speed <= 1.0):
        raise BadArgument(f"Expected 0 < speed <= 1 but got speed={speed!r}")
