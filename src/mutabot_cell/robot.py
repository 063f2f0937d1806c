"""A robot in the physics: its joints, servos, tool and encoders."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from mutabot_cell.models.assembly import FINGER_SENSORS, PAYLOAD_BODY, TOOL_SITE
from mutabot_cell.models.effectors import Fingers
from mutabot_cell.models.model import ROBOT_BODY
from mutabot_cell.models.robot import RobotModel

from .curve import Curve
from .errors import BadArgument
from .geometry import Array, Pose, Position, pose_of, rotation_from_euler


class Robot:
    """A robot of a simulation.

    Attributes:
        model: the robot as plain data.
        prefix: of all its names in the physics.
        joints: where its joints' angles are in `qpos`.
        dofs: where its joints' speeds and torques are in `qvel`, `qfrc_constraint` and their like.
        servos: where the inputs of its joints' servos are in `ctrl`.
        fingers: number of the servo that moves its fingers; -1 without fingers.
        sensors: where what its gripper measures is in `sensordata`: length, speed and force of the servo.
        site, body, payload: numbers of the tool point, of the body at its base, and of the payload's body.
        encoder_error: what each joint's encoder reads too much, rad; zero for a well calibrated arm. Servos,
            protective stop, planner and sensors know the encoders alone. Set it by `set_encoder_error`.
    """

    def __init__(
        self, physics: mujoco.MjModel, data: mujoco.MjData, model: RobotModel, prefix: str = ""
    ) -> None:
        self.model, self.prefix = model, prefix
        self._physics, self._data = physics, data
        joints = [physics.joint(prefix + name).id for name in model.joints]
        self.joints = _run(physics.jnt_qposadr[joints].tolist())
        self.dofs = _run(physics.jnt_dofadr[joints].tolist())
        self.servos = _run([physics.actuator(prefix + name).id for name in model.servos])
        self.site = int(physics.site(prefix + TOOL_SITE).id)
        self.body = int(physics.body(prefix + ROBOT_BODY).id)
        self.payload = int(physics.body(prefix + PAYLOAD_BODY).id)
        effector = None if model.tool is None else model.tool.effector
        self._fingers = effector if isinstance(effector, Fingers) else None
        self.fingers = -1 if self._fingers is None else physics.actuator(prefix + self._fingers.actuator).id
        if self._fingers is not None:
            first = int(physics.sensor(prefix + FINGER_SENSORS[0]).adr[0])
            self.sensors = slice(first, first + len(FINGER_SENSORS))
            self._closed = Curve(self._fingers.lengths, self._fingers.paths)
            self._sensed = data.sensordata[self.sensors]
        base = model.base
        self._base = np.array([base.x, base.y, base.z])
        turned = rotation_from_euler(base.theta_x, base.theta_y, base.theta_z)
        self._turned = None if (turned == np.eye(3)).all() else turned
        self.encoder_error: Array = np.zeros(len(joints))
        self._places = data.qpos  # a view of the physics' own memory

    def place_at_home(self) -> None:
        """Set joints and servos to the home position, fingers open; only at the start."""
        self._data.qpos[self.joints] = self.model.home
        self._data.ctrl[self.servos] = self.model.home

    def stiffness(self) -> Array:
        """Return the stiffness of each servo, Nm/rad, shape (joints,)."""
        gains: Array = self._physics.actuator_gainprm[self.servos, 0].copy()
        return gains

    def lag(self) -> Array:
        """Return each servo's lag, s, shape (joints,); times the wanted speed, it compensates a setpoint."""
        damping = -self._physics.actuator_biasprm[self.servos, 2] + self._physics.dof_damping[self.dofs]
        result: Array = damping / self.stiffness()
        return result

    def encoders(self) -> Array:
        """Return the joint angles, shape (joints,), rad, as the encoders report them, without noise."""
        read: Array = self._places[self.joints] + self.encoder_error
        return read

    def set_encoder_error(self, error: Sequence[float]) -> None:
        """Miscalibrate the encoders: the joints move to where the encoders read what they read now.

        Args:
            error: encoder minus joint, rad, one per joint.

        Raises:
            BadArgument: not one number per joint.
        """
        if len(error) != len(self.encoder_error):
            raise BadArgument(
                f"Expected {len(self.encoder_error)} encoder errors, one per joint, but got {error!r}"
            )
        read = self.encoders()
        self.encoder_error[:] = error
        self._places[self.joints] = read - self.encoder_error
        mujoco.mj_forward(self._physics, self._data)

    def closed_path(self) -> float:
        """Return how far the fingers have closed, m; 0 when they are open, and without fingers."""
        return 0.0 if self._fingers is None else self.finger_state()[0]

    def opening(self) -> float:
        """Return the distance between the pads by the fingers' servo, m; 0 without fingers."""
        return 0.0 if self._fingers is None else self._fingers.stroke - self.closed_path()

    def closing_speed(self) -> float:
        """Return how fast the fingers close, m/s."""
        return 0.0 if self._fingers is None else self.finger_state()[1]

    def finger_state(self) -> tuple[float, float, float]:
        """Return how far and how fast the fingers close, m and m/s, and their servo's force in its unit."""
        return self.finger_state_of(*self._sensed.tolist())

    def finger_state_of(self, length: float, speed: float, force: float) -> tuple[float, float, float]:
        """Return the fingers' state from what the sensors of the servo read."""
        return self._closed(length), speed * self._closed.slope(length), force

    def tool_pose(self) -> Pose:
        """Return the exact tool pose, base frame."""
        rotation = self._data.site_xmat[self.site].reshape(3, 3)
        if self._turned is not None:
            rotation = self._turned.T @ rotation
        return pose_of(self._tool_place(), rotation)

    def tool_position(self) -> Position:
        """Return the exact tool position, base frame; faster than the pose, for checks at every tick."""
        return Position(*self._tool_place().tolist())

    def in_base_frame(self, direction: Array) -> Array:
        """Return a direction of the world, shape (3,), in the robot's base frame."""
        return direction if self._turned is None else self._turned.T @ direction

    def _tool_place(self) -> Array:
        place: Array = self._data.site_xpos[self.site] - self._base
        return place if self._turned is None else self._turned.T @ place


def _run(numbers: list[int]) -> slice:
    """Return the slice of these consecutive numbers."""
    first, last = numbers[0], numbers[-1]
    if numbers != list(range(first, last + 1)):
        raise BadArgument(f"joints and servos must follow each other in the model, but they are {numbers}")
    return slice(first, last + 1)
