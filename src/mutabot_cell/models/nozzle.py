"""A dispensing nozzle as a tool: a cartridge and a needle with typical dimensions, chosen by us."""

from __future__ import annotations

import mujoco

from .options import HEAD
from .tool import Tool

_MASS = 0.6
_CARTRIDGE, _NEEDLE = 0.025, 0.002
_GREY, _METAL = "0.35 0.37 0.40 1", "0.70 0.71 0.73 1"


def nozzle(length: float = 0.160, needle: float = 0.040) -> Tool:
    """Return a nozzle along the flange's axis; the tool point is its tip.

    Args:
        length: from the flange to the tip, m.
        needle: length of the thin part, m.
    """
    half = (length - needle) / 2
    xml = (
        f'<body name="nozzle" gravcomp="1"><geom name="cartridge" class="gripper" type="cylinder" '
        f'size="{_CARTRIDGE} {half}" pos="0 0 {half}" mass="{_MASS}" rgba="{_GREY}"/>'
        f'<geom name="needle" class="gripper" type="cylinder" size="{_NEEDLE} {needle / 2}" '
        f'pos="0 0 {length - needle / 2}" mass="0.005" rgba="{_METAL}"/></body>'
    )
    spec = mujoco.MjSpec.from_string(f'<mujoco model="nozzle">{HEAD}<worldbody>{xml}</worldbody></mujoco>')
    return Tool("dispensing nozzle", spec, "nozzle", (0.0, 0.0, length), None, palm=-length / 2)
