"""A suction cup with a flat lip on a spring plunger, as a tool with typical dimensions, chosen by us."""

from __future__ import annotations

import math

import mujoco

from .effectors import LIP_FRICTION, SENSED_GAP, SuctionCup
from .options import HEAD
from .tool import Tool
from .vacuum import Ejector

STROKE = 0.015
"""By how much the plunger gives way, m."""
PRELOAD, STIFFNESS = 3.0, 500.0
"""Force of its spring at first, N, and how much it grows, N/m."""

_POINTS = 8
_LIP = 0.001
_MASS, _LIP_MASS = 0.25, 0.03
_BLACK, _METAL, _RUBBER = "0.13 0.13 0.14 1", "0.70 0.71 0.73 1", "0.16 0.30 0.55 1"


def suction_cup(
    diameter: float = 0.030,
    *,
    length: float = 0.120,
    friction: float = LIP_FRICTION,
    leak: float = 0.0,
    ejector: Ejector | None = None,
) -> Tool:
    """Return a suction cup on a spring plunger.

    Args:
        diameter: of its lip, m.
        length: from the flange to the lip, m.
        friction: of the lip on a dry part.
        leak: opening that the lip leaves when the cup seals, m².
        ejector: what makes the vacuum.
    """
    effector = SuctionCup(
        body="cup",
        lip=tuple(f"lip {number}" for number in range(_POINTS)),
        diameter=diameter,
        friction=friction,
        leak=leak,
        ejector=ejector or Ejector(),
    )
    xml = _xml(effector, length)
    return Tool(
        name=f"suction cup {1000 * diameter:.0f} mm",
        spec=mujoco.MjSpec.from_string(
            f'<mujoco model="suction">{HEAD}<worldbody>{xml}</worldbody></mujoco>'
        ),
        body="suction",
        point=(0.0, 0.0, length),
        palm=-length / 2,
        effector=effector,
    )


def _xml(cup: SuctionCup, length: float) -> str:
    housing = (length - STROKE - 0.02) / 2
    return (
        f'<body name="suction" gravcomp="1"><geom name="suction" class="gripper" type="cylinder" '
        f'size="0.02 {housing}" pos="0 0 {housing}" mass="{_MASS - _LIP_MASS}" rgba="{_BLACK}"/>'
        f'<body name="cup" pos="0 0 {length}" gravcomp="1">'
        f'<inertial pos="0 0 -0.01" mass="{_LIP_MASS}" diaginertia="3e-6 3e-6 3e-6"/>'
        f'<joint name="plunger" type="slide" axis="0 0 -1" range="0 {STROKE}" limited="true" '
        f'stiffness="{STIFFNESS}" springref="{-PRELOAD / STIFFNESS}" damping="5" armature="0.05" '
        f'solreflimit="0.015 1" solimplimit="0.99 0.999 0.001"/>'
        f'<geom class="looks" type="cylinder" size="0.006 0.015" pos="0 0 -0.025" rgba="{_METAL}"/>'
        f'<geom class="looks" type="cylinder" size="{cup.diameter / 2} 0.005" pos="0 0 -0.005" '
        f'rgba="{_RUBBER}"/>{"".join(_point_xml(cup, number) for number in range(_POINTS))}</body></body>'
    )


def _point_xml(cup: SuctionCup, number: int) -> str:
    angle = 2 * math.pi * number / _POINTS
    x, y = cup.diameter / 2 * math.cos(angle), cup.diameter / 2 * math.sin(angle)
    return (
        f'<geom name="{cup.lip[number]}" class="gripper" type="sphere" size="{_LIP}" '
        f'pos="{x:.17g} {y:.17g} {-_LIP}" mass="0" priority="2" condim="3" gap="{SENSED_GAP}" '
        f'solref="0.006 1" solimp="0.95 0.99 0.001" friction="{cup.friction} 0.005 0.0001" rgba="{_RUBBER}"/>'
    )
