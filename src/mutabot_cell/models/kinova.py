"""The Kinova Gen3 arm with 7 joints: published kinematics, masses and limits, and its shape.

Source: the maker's public robot description (joint origins, inertias, torque and speed limits) and user guide
(joint and acceleration limits, peak torque, payload). Link shapes are our own capsules.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import mujoco

from . import robotiq
from .limits import JointLimits, ToolLimits
from .options import HEAD
from .robot import RobotModel, SphericalWrist

CONTINUOUS = math.inf


@dataclass(frozen=True, slots=True)
class Joint:
    """One revolute joint about its own z axis.

    Attributes:
        origin: place in the parent frame, m.
        turn: rotation of the frame about the parent's x axis, rad.
        limit: allowed angle on both sides of zero, rad; infinite for a continuous joint.
        mass: of the link that the joint carries, kg.
        centre: of that link's mass, in the joint's frame, m.
        inertia: of that link about its centre of mass, in the joint's axes: xx, yy, zz, xy, xz, yz, kg m².
        torque: what the joint can give without end, Nm.
        peak_torque: what it can give for a short time, Nm.
        speed: limit, rad/s.
        acceleration: limit, rad/s².
    """

    origin: tuple[float, float, float]
    turn: float
    limit: float
    mass: float
    centre: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]
    torque: float
    peak_torque: float
    speed: float
    acceleration: float


_QUARTER = math.pi / 2
JOINTS: tuple[Joint, ...] = (
    Joint(
        (0.0, 0.0, 0.15643), math.pi, CONTINUOUS, 1.3773, (-2.3e-5, -0.010364, -0.07336),
        (0.00457, 0.004831, 0.001409, 1.0e-6, 2.0e-6, 0.000448), 39.0, 105.0, 1.39, 5.2,
    ),
    Joint(
        (0.0, 0.005375, -0.12838), _QUARTER, math.radians(128.9), 1.1636, (-4.4e-5, -0.09958, -0.013278),
        (0.011088, 0.001072, 0.011255, 5.0e-6, 0.0, -0.000691), 39.0, 105.0, 1.39, 5.2,
    ),
    Joint(
        (0.0, -0.21038, -0.006375), -_QUARTER, CONTINUOUS, 1.1636, (-4.4e-5, -0.006641, -0.117892),
        (0.010932, 0.011127, 0.001043, 0.0, -7.0e-6, 0.000606), 39.0, 105.0, 1.39, 5.2,
    ),
    Joint(
        (0.0, 0.006375, -0.21038), _QUARTER, math.radians(147.8), 0.9302, (-1.8e-5, -0.075478, -0.015006),
        (0.008147, 0.000631, 0.008316, -1.0e-6, 0.0, -0.0005), 39.0, 105.0, 1.39, 5.2,
    ),
    Joint(
        (0.0, -0.20843, -0.006375), -_QUARTER, CONTINUOUS, 0.6781, (1.0e-6, -0.009432, -0.063883),
        (0.001596, 0.001607, 0.000399, 0.0, 0.0, 0.000256), 9.0, 52.0, 1.22, 10.0,
    ),
    Joint(
        (0.0, 0.00017505, -0.10593), _QUARTER, math.radians(120.3), 0.6781, (1.0e-6, -0.045483, -0.00965),
        (0.001641, 0.00041, 0.001641, 0.0, 0.0, -0.000278), 9.0, 52.0, 1.22, 10.0,
    ),
    Joint(
        (0.0, -0.10593, -0.00017505), -_QUARTER, CONTINUOUS, 0.5, (0.000281, 0.011402, -0.029798),
        (0.000587, 0.000369, 0.000609, 3.0e-6, 3.0e-6, -0.000118), 9.0, 52.0, 1.22, 10.0,
    ),
)  # fmt: skip
JOINT_COUNT = len(JOINTS)
INTERFACE_OFFSET = (0.0, 0.0, -0.0615250)
BASE_MASS = 1.697
PAYLOAD = 4.0
"""What the maker rates the arm for at mid-range, without end and without a gripper, kg."""
JERK_RATIO = 10.0
"""Jerk limit of a joint divided by its acceleration limit, 1/s (our choice: reached within 0.1 s)."""

HOME_DEGREES = (0.0, 15.0, 180.0, -130.0, 0.0, 55.0, 90.0)
HOME = tuple(math.radians(angle) for angle in HOME_DEGREES)

TOOL_SPEED = 0.55
TOOL_TURN_SPEED = math.radians(60.0)
TOOL_ACCELERATION = 2.0
TOOL_TURN_ACCELERATION = math.radians(240.0)
TOOL_JERK = 20.0
TOOL_TURN_JERK = math.radians(2400.0)

# Servo of each joint: stiffness (Nm/rad) and rotor inertia seen at the output (kg m²), our choice.
_STIFFNESS = (6000.0, 6000.0, 4000.0, 4000.0, 1500.0, 1500.0, 1000.0)
_ROTOR_INERTIA = (0.5, 0.5, 0.3, 0.3, 0.1, 0.1, 0.1)
_DAMPING = (180.0, 180.0, 110.0, 110.0, 30.0, 30.0, 20.0)
EXTERNAL_TORQUE_LIMIT = (20.0, 20.0, 20.0, 20.0, 6.0, 6.0, 6.0)
"""External torque on a joint that stops the arm, Nm (our choice)."""

_LINK_RADIUS = (0.045, 0.045, 0.042, 0.042, 0.037, 0.037, 0.037)
_LIGHT = "0.92 0.92 0.93 1"
_DARK = "0.24 0.25 0.27 1"


def _turn(angle: float) -> str:
    return f"{math.cos(angle / 2):.17g} {math.sin(angle / 2):.17g} 0 0"


def _numbers(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def _link_shape(number: int, end: tuple[float, float, float]) -> str:
    radius = _LINK_RADIUS[number - 1]
    length = math.sqrt(sum(part * part for part in end))
    reach = tuple(part * max(0.0, 1 - 0.25 * radius / length) for part in end)
    return (
        f'<geom name="link {number}" class="arm" type="capsule" size="{radius}" '
        f'fromto="0 0 0 {_numbers(reach)}" rgba="{_LIGHT}"/>'
        f'<geom class="looks" type="cylinder" size="{radius + 0.0015} 0.012" rgba="{_DARK}"/>'
    )


def arm_xml() -> str:
    """Return MJCF of the arm, base at the parent's origin; site "flange" is the maker's interface frame."""
    opening: list[str] = [
        f'<body name="base"><geom name="base" class="arm" type="cylinder" size="0.05 0.06" pos="0 0 0.06" '
        f'mass="{BASE_MASS}" rgba="{_LIGHT}"/><geom class="looks" type="cylinder" size="0.0515 0.012" '
        f'pos="0 0 0.12" rgba="{_DARK}"/>'
    ]
    for index, joint in enumerate(JOINTS):
        number = index + 1
        limited = "" if math.isinf(joint.limit) else f' range="{-joint.limit} {joint.limit}" limited="true"'
        end = JOINTS[index + 1].origin if number < JOINT_COUNT else INTERFACE_OFFSET
        opening.append(
            f'<body name="link {number}" pos="{_numbers(joint.origin)}" quat="{_turn(joint.turn)}" '
            f'gravcomp="1"><inertial pos="{_numbers(joint.centre)}" mass="{joint.mass}" '
            f'fullinertia="{_numbers(joint.inertia)}"/>'
            f'<joint name="joint {number}" armature="{_ROTOR_INERTIA[index]}" actuatorgravcomp="true" '
            f'actuatorfrclimited="true" actuatorfrcrange="{-joint.peak_torque} {joint.peak_torque}"'
            f"{limited}/>" + _link_shape(number, end)
        )
    camera = (
        '<geom class="looks" type="box" size="0.035 0.012 0.03" pos="0 -0.042 -0.03" '
        f'rgba="{_DARK}"/>'  # the vision module on the bracelet
    )
    interface = (
        f'<body name="interface" pos="{_numbers(INTERFACE_OFFSET)}" quat="{_turn(math.pi)}" gravcomp="1">'
        '<site name="flange" size="0.002" rgba="0 0 0 0"/></body>'
    )
    return "".join(opening) + camera + interface + "</body>" * (JOINT_COUNT + 1)


def actuators_xml() -> str:
    """Return MJCF of the joints' position servos, in the joints' order."""
    return "".join(
        f'<position name="servo {index + 1}" joint="joint {index + 1}" kp="{_STIFFNESS[index]}" '
        f'kv="{_DAMPING[index]}"/>'
        for index in range(JOINT_COUNT)
    )


@cache
def gen3() -> RobotModel:
    """Return the Kinova Gen3 with the Robotiq 2F-85: the robot of the published experiment."""
    accelerations = tuple(joint.acceleration for joint in JOINTS)
    return RobotModel(
        name="Kinova Gen3",
        spec=mujoco.MjSpec.from_string(
            f'<mujoco model="arm">{HEAD}<worldbody>{arm_xml()}</worldbody>'
            f"<actuator>{actuators_xml()}</actuator></mujoco>"
        ),
        joints=tuple(f"joint {number}" for number in range(1, JOINT_COUNT + 1)),
        servos=tuple(f"servo {number}" for number in range(1, JOINT_COUNT + 1)),
        home=HOME,
        ranges=tuple((-joint.limit, joint.limit) for joint in JOINTS),
        limits=JointLimits(
            speed=tuple(joint.speed for joint in JOINTS),
            acceleration=accelerations,
            jerk=tuple(value * JERK_RATIO for value in accelerations),
            torque=tuple(joint.torque for joint in JOINTS),
            peak_torque=tuple(joint.peak_torque for joint in JOINTS),
            external_torque=EXTERNAL_TORQUE_LIMIT,
        ),
        tool_limits=ToolLimits(
            TOOL_SPEED, TOOL_TURN_SPEED, TOOL_ACCELERATION, TOOL_TURN_ACCELERATION, TOOL_JERK, TOOL_TURN_JERK
        ),
        flange="flange",
        payload=PAYLOAD,
        tool=robotiq.gripper(),
        reach=SphericalWrist(
            shoulder=(0.0, 0.0, JOINTS[0].origin[2] - JOINTS[1].origin[2]),
            length=-(JOINTS[2].origin[1] + JOINTS[3].origin[2] + JOINTS[4].origin[1] + JOINTS[5].origin[2]),
            to_flange=-JOINTS[6].origin[1] - INTERFACE_OFFSET[2],
        ),
    )
