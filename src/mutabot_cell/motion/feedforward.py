"""Computes a planned motion's torques and adds them to the setpoints of soft servos."""

from __future__ import annotations

import mujoco
import numpy as np

from mutabot_cell.geometry import Array
from mutabot_cell.models.assembly import PAYLOAD_BODY, build_robot
from mutabot_cell.models.robot import RobotModel

from .trajectory import Motion

_EVERY = 5
"""Torques are computed at every fifth physics step, and are straight between."""
_SLOW = 0.01
"""Below this speed dry friction is not counted in full, rad/s: a joint may stand."""


class FeedForward:
    """The controller's model of the robot's masses, including the tool.

    Args:
        robot: whose controller it is.
        stiffness: of the joints' servos, shape (joints,), Nm/rad.
    """

    def __init__(self, robot: RobotModel, stiffness: Array) -> None:
        self._model = build_robot(robot)
        self._model.opt.gravity[:] = 0  # which is compensated elsewhere
        self._data = mujoco.MjData(self._model)
        joints = [self._model.joint(name).id for name in robot.joints]
        self._places, self._dofs = self._model.jnt_qposadr[joints], self._model.jnt_dofadr[joints]
        self._armature, self._friction = self._model.dof_armature, self._model.dof_frictionloss
        self._payload = int(self._model.body(PAYLOAD_BODY).id)
        self._stiffness = stiffness

    def set_payload(self, mass: float, centre: tuple[float, float, float]) -> None:
        """Set the declared payload, kg, and its centre of mass in the tool frame, m."""
        self._model.body_mass[self._payload] = mass
        self._model.body_ipos[self._payload] = centre

    def offsets(self, motion: Motion, step: float) -> Array:
        """Return the offsets to add to the setpoints, shape (steps, joints), rad.

        Args:
            step: of the motion, s.
        """
        count = len(motion.joints)
        if count < 2:
            return np.zeros_like(motion.joints)
        accelerations = np.gradient(motion.speeds, step, axis=0)
        samples = np.unique(np.append(np.arange(0, count, _EVERY), count - 1))
        torques = np.array(
            [self._torque(motion.joints[i], motion.speeds[i], accelerations[i]) for i in samples.tolist()]
        )
        steps = np.arange(count)
        between = [np.interp(steps, samples, torques[:, joint]) for joint in range(torques.shape[1])]
        offsets: Array = np.stack(between, axis=1) / self._stiffness
        return offsets

    def _torque(self, joints: Array, speeds: Array, accelerations: Array) -> Array:
        """Return the torque of inertia, Coriolis forces and dry friction, shape (joints,), Nm."""
        model, data = self._model, self._data
        data.qpos[self._places] = joints
        data.qvel[self._dofs] = speeds
        data.qacc[self._dofs] = accelerations
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        torque = np.zeros(model.nv)
        mujoco.mj_rne(model, data, 1, torque)
        rubbing = self._friction[self._dofs] * np.clip(speeds / _SLOW, -1.0, 1.0)
        result: Array = torque[self._dofs] + self._armature[self._dofs] * accelerations + rubbing
        return result
