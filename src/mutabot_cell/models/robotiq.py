"""The Robotiq 2F-85 gripper as two coupled finger pads on slides.

Source of the figures: the maker's data sheet (stroke 85 mm, force 20..235 N, finger speed 20..150 mm/s, about
0.9 kg).
The real fingers hang on linkages and stay parallel; slides give the pads the same motion.
"""

from __future__ import annotations

from functools import cache

import mujoco

from .effectors import Fingers
from .options import HEAD
from .tool import Tool

TOOL_LENGTH = 0.12
"""From the interface to the tool point, m."""
_DISTANCE_START = 0.085
"""The distance sensor sits in the gripper's palm, this far beyond the interface, m."""
STROKE = 0.085
FORCE_RANGE = (20.0, 235.0)
SPEED_RANGE = (0.020, 0.150)
MASS = 0.9

_FINGER_MASS = 0.08
_STIFFNESS = 40000.0
_DAMPING = 400.0
_PAD = (0.004, 0.011, 0.019)
"""Half thickness, half width and half length of a finger pad, m."""
_PAD_CENTRE = 0.122
"""How far beyond the interface the middle of the pads lies, m."""
_BLACK = "0.13 0.13 0.14 1"
_GREY = "0.45 0.46 0.48 1"
_RUBBER = "0.2 0.2 0.22 1"


def _finger(name: str, side: int) -> str:
    thickness, width, length = _PAD
    return (
        f'<body name="{name} finger" pos="{side * (STROKE / 2 + thickness)} 0 {_PAD_CENTRE}" gravcomp="1">'
        f'<joint name="{name} finger" type="slide" axis="{-side} 0 0" range="0 {STROKE / 2}" limited="true" '
        f'armature="0.4"/>'
        f'<geom name="{name} pad" class="gripper" type="box" size="{thickness} {width} {length}" '
        f'mass="{_FINGER_MASS}" friction="1 0.005 0.0001" rgba="{_RUBBER}"/>'
        f'<geom name="{name} finger" class="gripper" type="box" size="0.006 0.010 0.022" '
        f'pos="{side * (thickness + 0.006)} 0 -0.006" mass="0" rgba="{_GREY}"/>'
        f'<geom class="looks" type="capsule" size="0.006" '
        f'fromto="{side * 0.012} 0 -0.025 {-side * 0.008} 0 -0.062" rgba="{_GREY}"/>'
        "</body>"
    )


def gripper_xml() -> str:
    """Return MJCF of the gripper for the arm's interface frame; the fingers close along its x axis."""
    return (
        '<body name="gripper" gravcomp="1">'
        f'<geom name="gripper" class="gripper" type="capsule" size="0.036" fromto="0 0 0.01 0 0 0.05" '
        f'mass="{MASS - 2 * _FINGER_MASS}" rgba="{_BLACK}"/>'
        f'<geom class="looks" type="box" size="0.05 0.02 0.012" pos="0 0 0.072" rgba="{_BLACK}"/>'
        + _finger("left", 1)
        + _finger("right", -1)
        + "</body>"
    )


def coupling_xml() -> str:
    """Return MJCF that keeps both fingers at the same distance from the middle."""
    return '<joint joint1="left finger" joint2="right finger" solref="0.004 1"/>'


def tendon_xml() -> str:
    """Return MJCF of the tendon whose length is the path both fingers have closed, 0..STROKE m."""
    return (
        '<fixed name="closing"><joint joint="left finger" coef="1"/>'
        '<joint joint="right finger" coef="1"/></fixed>'
    )


def actuator_xml() -> str:
    """Return MJCF of the finger servo, with the largest grip force."""
    return (
        f'<position name="fingers" tendon="closing" kp="{_STIFFNESS}" kv="{_DAMPING}" '
        f'forcelimited="true" forcerange="{-FORCE_RANGE[1]} {FORCE_RANGE[1]}"/>'
    )


@cache
def gripper() -> Tool:
    """Return the gripper as a tool."""
    return Tool(
        name="Robotiq 2F-85",
        spec=mujoco.MjSpec.from_string(
            f'<mujoco model="gripper">{HEAD}<worldbody>{gripper_xml()}</worldbody>'
            f"<tendon>{tendon_xml()}</tendon><equality>{coupling_xml()}</equality>"
            f"<actuator>{actuator_xml()}</actuator></mujoco>"
        ),
        body="gripper",
        point=(0.0, 0.0, TOOL_LENGTH),
        palm=_DISTANCE_START - TOOL_LENGTH,
        effector=Fingers(
            actuator="fingers",
            pads=("left pad", "right pad"),
            stroke=STROKE,
            paths=(0.0, STROKE),
            controls=(0.0, STROKE),
            lengths=(0.0, STROKE),
            force_range=FORCE_RANGE,
            speed_range=SPEED_RANGE,
            force=60.0,
            speed=0.1,
        ),
    )
