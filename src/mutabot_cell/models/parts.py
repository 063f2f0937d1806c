"""Parts and fixtures as MuJoCo bodies, with contacts that have the friction of pairs of materials."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np

from mutabot_cell.geometry import quaternion_from_euler
from mutabot_cell.parts import Box, Cylinder, Mesh, Part, Vector3
from mutabot_cell.scene import FRICTION_ON_SILICONE, FRICTION_ON_STEEL

from .effectors import SENSED_GAP, Fingers, SuctionCup
from .options import PHYSICS_STEP

LANDING = (0.008, 0.8)
"""Time constant (s) and damping ratio of what a part lands on: it rebounds with a tenth of its speed, as
cardboard does on rubber."""
IMPEDANCE = (0.95, 0.99, 0.001, 0.5, 2.0)
ROLLING = 5e-4
"""Lever of the rolling resistance of a cylinder, m: hard on rubber, within the range that tables give."""

_TWIST, _NO_ROLLING = 0.005, 0.0001
_GRIP, _LIP = (0.004, 1.0), (0.006, 1.0)
_BRAKE, _LIP_BRAKE = 1.8, 1.4
"""Share of slip that friction brakes in a step. MuJoCo's constraint leaves out how the contact itself
accelerates (J' v, about v²/r while the arm moves), so a part of it stays as slip: per step
(1 / brake - 1/2) J' v dt², which vanishes at 2, where slip would swing for ever. A part that slides along a
lip swings at 1.8 already."""
_LIP_ADHESION = 1e-6
"""N; nothing to hold with, but so that MuJoCo keeps a contact that slides, and is lifted by that for some
micrometres, instead of opening and closing it from step to step."""


def add_part(spec: mujoco.MjSpec, part: Part) -> None:
    """Put a part into the world, free to move."""
    x, y, z = part.position
    body = spec.worldbody.add_body(
        name=part.name, pos=(x, y, z + part.middle_height), quat=quaternion_from_euler(*part.angles)
    )
    body.add_freejoint(name=part.name)
    geom = body.add_geom(
        spec.find_default("box"),
        name=part.name,
        mass=part.mass,
        priority=1,
        solref=LANDING,
        solimp=IMPEDANCE,
        friction=(_friction(part, FRICTION_ON_STEEL), _TWIST, _rolling(part)),
        condim=_dimensions(part),
        rgba=part.looks,
    )
    _shape(spec, geom, part)
    if part.centre_of_mass is not None:
        _move_mass(body, part, part.centre_of_mass)


def add_surfaces(spec: mujoco.MjSpec, part: Part, surfaces: Iterable[tuple[str, float]]) -> None:
    """Add contacts of a part with what it may lie on: friction depends on both materials.

    Args:
        surfaces: name of a shape, and its friction coefficient against a dry part.
    """
    for name, friction in surfaces:
        spec.add_pair(
            geomname1=name,
            geomname2=part.name,
            condim=_dimensions(part),
            solref=LANDING,
            solimp=IMPEDANCE,
            friction=_pair_friction(part, friction),
        )


def add_grip(spec: mujoco.MjSpec, part: Part, prefix: str, effector: Fingers | SuctionCup) -> None:
    """Add contacts of a part with the effector that grips it.

    They are stiffer than others: what is gripped must turn with the fingers. As stiff as that, a falling part
    would bounce, for numerical reasons. A suction cup notices a part before its lip touches it.

    Args:
        prefix: of the robot's names.
    """
    is_cup = isinstance(effector, SuctionCup)
    friction = effector.friction if isinstance(effector, SuctionCup) else FRICTION_ON_SILICONE
    for name in effector.lip if isinstance(effector, SuctionCup) else effector.pads:
        pair = spec.add_pair(
            geomname1=prefix + name,
            geomname2=part.name,
            condim=3,
            gap=SENSED_GAP if is_cup else 0.0,
            solref=_LIP if is_cup else _GRIP,
            solimp=IMPEDANCE,
            friction=_pair_friction(part, friction),
        )
        pair.solreffriction = (0.0, -(_LIP_BRAKE if is_cup else _BRAKE) / PHYSICS_STEP)
        pair.adhesion = _LIP_ADHESION if is_cup else 0.0


def read_mesh(path: str, scale: float = 1.0) -> tuple[Vector3, ...]:
    """Return the points of a mesh file (STL, OBJ), for `Mesh(vertices=...)`.

    Args:
        scale: m per unit of the file; 0.001 where it is in mm.
    """
    spec = mujoco.MjSpec()
    spec.add_mesh(name="mesh", file=path, scale=(scale,) * 3)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="mesh")
    model = spec.compile()
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, model.mesh_quat[0])
    points = model.mesh_vert.astype(float) @ turned.reshape(3, 3).T + model.mesh_pos[0]
    return tuple((x, y, z) for x, y, z in points.tolist())


def _shape(spec: mujoco.MjSpec, geom: mujoco.MjsGeom, part: Part) -> None:
    if isinstance(part, Box):
        geom.type, geom.size = mujoco.mjtGeom.mjGEOM_BOX, np.array(part.size) / 2
    elif isinstance(part, Cylinder):
        geom.type, geom.size = mujoco.mjtGeom.mjGEOM_CYLINDER, (part.diameter / 2, part.height / 2, 0)
    elif isinstance(part, Mesh):
        spec.add_mesh(name=part.name, uservert=np.array(part.centred()).ravel())
        geom.type, geom.meshname = mujoco.mjtGeom.mjGEOM_MESH, part.name


def _move_mass(body: mujoco.MjsBody, part: Part, centre: Vector3) -> None:
    """Give the body the inertia of a uniform part, about another centre of mass.

    Such a body is not `simple` to MuJoCo, so that its centre of mass can be changed at run time too.
    """
    alone = mujoco.MjSpec()
    _shape(alone, alone.worldbody.add_body(name="part").add_geom(mass=part.mass), part)
    uniform = alone.compile().body("part")
    body.explicitinertial = True
    body.mass, body.ipos, body.iquat, body.inertia = part.mass, centre, uniform.iquat, uniform.inertia
    body.simple = False


def _friction(part: Part, material: float) -> float:
    return material if part.friction is None else part.friction


def _rolling(part: Part) -> float:
    return ROLLING if isinstance(part, Cylinder) else _NO_ROLLING


def _dimensions(part: Part) -> int:
    """Return the number of friction directions: a cylinder has rolling resistance too."""
    return 6 if isinstance(part, Cylinder) else 3


def _pair_friction(part: Part, material: float) -> tuple[float, float, float, float, float]:
    friction, rolling = _friction(part, material), _rolling(part)
    return (friction, friction, _TWIST, rolling, rolling)
