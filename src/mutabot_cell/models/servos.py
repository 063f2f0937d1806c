"""Servos of a robot's joints: from its file, or made from the joints' largest torques."""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco

from .limits import JointLimits

FULL_TORQUE_AT = math.radians(1.0)
"""A servo that is made gives its joint's peak torque this far from its setpoint, rad (our choice)."""
DAMPING_TIME = 0.03
"""Damping over stiffness of a servo that is made, s (our choice)."""
_ROTOR_SHARE = 0.5e-2
"""Rotor inertia (kg m²) of a joint whose file has none, for each Nm of its peak torque (our choice)."""


def servos_of(spec: mujoco.MjSpec, joints: Sequence[str]) -> tuple[str, ...] | None:
    """Return the names of the file's position servos of the joints; None unless each joint has one."""
    by_joint = {known_servo.target: known_servo for known_servo in spec.actuators if _is_servo(known_servo)}
    found = [by_joint.get(name) for name in joints]
    if any(servo is None for servo in found):
        return None
    for joint, actuator in zip(joints, found, strict=True):
        if actuator is not None and not actuator.name:
            actuator.name = f"servo of {joint}"
    return tuple(servo.name for servo in found if servo is not None)


def make_servos(spec: mujoco.MjSpec, joints: Sequence[str], limits: JointLimits) -> tuple[str, ...]:
    """Replace the joints' actuators by position servos, and return their names."""
    for actuator in [candidate for candidate in spec.actuators if candidate.target in joints]:
        spec.delete(actuator)
    for joint, peak in zip(joints, limits.peak_torque, strict=True):
        stiffness = peak / FULL_TORQUE_AT
        servo = spec.add_actuator(name=f"servo of {joint}", target=joint)
        servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
        servo.set_to_position(kp=stiffness, kv=DAMPING_TIME * stiffness)
        joint_spec = spec.joint(joint)
        joint_spec.actfrclimited, joint_spec.actfrcrange = True, (-peak, peak)
        if float(joint_spec.armature) <= 0.0:
            joint_spec.armature = _ROTOR_SHARE * peak
    return tuple(f"servo of {joint}" for joint in joints)


def torque_of(spec: mujoco.MjSpec, model: mujoco.MjModel, joint: str) -> float | None:
    """Return the largest torque of a joint according to the file, Nm; None if it does not say."""
    found = model.joint(joint)
    if model.jnt_actfrclimited[found.id]:
        return float(model.jnt_actfrcrange[found.id, 1])
    for number in range(model.nu):
        of_joint = model.actuator_trntype[number] == mujoco.mjtTrn.mjTRN_JOINT
        if not of_joint or int(model.actuator_trnid[number, 0]) != found.id:
            continue
        gear = abs(float(model.actuator_gear[number, 0]))
        if model.actuator_forcelimited[number]:
            return gear * float(model.actuator_forcerange[number, 1])
        if (
            model.actuator_biastype[number] == mujoco.mjtBias.mjBIAS_NONE
            and model.actuator_ctrllimited[number]
        ):
            return gear * float(model.actuator_gainprm[number, 0] * model.actuator_ctrlrange[number, 1])
    return None


def _is_servo(actuator: mujoco.MjsActuator) -> bool:
    """Return whether an actuator's input is a joint position, in the joint's unit."""
    stiffness = float(actuator.gainprm[0])
    return (
        actuator.trntype == mujoco.mjtTrn.mjTRN_JOINT
        and actuator.biastype == mujoco.mjtBias.mjBIAS_AFFINE
        and stiffness > 0
        and float(actuator.biasprm[1]) == -stiffness
        and float(actuator.gear[0]) == 1.0
    )
