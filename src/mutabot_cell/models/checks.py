"""Checks a robot's file: errors name what is missing, where, and what to add."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike

import mujoco

from mutabot_cell.errors import BadModel

from .options import compile_quietly

LONGEST, SHORTEST = 10.0, 0.05
"""Of an arm, from its base to its flange, m. Beyond them the unit is wrong."""
_LIGHTEST = 0.1
"""Of all links together, kg."""

FilePath = str | PathLike[str]


def compiled(spec: mujoco.MjSpec, path: FilePath) -> mujoco.MjModel:
    """Return the compiled model. Raises BadModel if MuJoCo refuses it."""
    try:
        return compile_quietly(spec)
    except (ValueError, mujoco.FatalError) as error:
        text = str(error).strip()
        advice = ""
        if "mass" in text and "inertia" in text:
            advice = (
                '; add <inertial mass="..." pos="..." diaginertia="..."/> (kg, m, kg m²) to the body it names'
            )
        elif "file" in text:
            advice = (
                "; meshes are looked for beside the file, in the folder that its compiler's meshdir names"
            )
        raise BadModel(f"MuJoCo cannot build {path}: {text}{advice}") from error


def check_chain(chain: Sequence[mujoco.MjsBody], path: FilePath) -> list[mujoco.MjsJoint]:
    """Return the joints of the chain from base to flange. Raises BadModel if they cannot be an arm's."""
    joints = []
    for body in chain:
        own = list(body.joints)
        if len(own) > 1:
            raise BadModel(
                f"body {body.name!r} of {path} has {len(own)} joints; links of an arm have one each"
            )
        joints += own
    for joint in joints:
        if joint.type != mujoco.mjtJoint.mjJNT_HINGE:
            raise BadModel(
                f"joint {joint.name!r} of {path} does not turn about an axis, as an arm's do. "
                "For a robot that is a part of a file say root=..., the name of its first body"
            )
        if not joint.name:
            raise BadModel(
                f"a joint of {path} has no name: add name=... to it, in body {joint.parent.name!r}"
            )
    if len(joints) not in (6, 7):
        raise BadModel(
            f"{len(joints)} joints lie between base and tool site of {path}; an arm has six or seven: "
            "is the site on the last link?"
        )
    return joints


def check_masses(model: mujoco.MjModel, joints: Sequence[str], path: FilePath) -> None:
    """Raise BadModel if links have no mass."""
    bodies = [int(model.joint(name).bodyid[0]) for name in joints]
    total = float(sum(model.body_mass[body] for body in bodies))
    if total < _LIGHTEST:
        raise BadModel(
            f"the links of {path} weigh {total:.3g} kg together: add <inertial mass=... (kg) .../> to "
            f"{', '.join(repr(model.body(body).name) for body in bodies)}"
        )


def check_touch(model: mujoco.MjModel, chain: Sequence[mujoco.MjsBody], path: FilePath) -> None:
    """Raise BadModel if the arm collides with nothing."""
    bodies = {model.body(body.name).id for body in chain if body.name}
    for geom in range(model.ngeom):
        touches = model.geom_contype[geom] or model.geom_conaffinity[geom]
        if touches and int(model.geom_bodyid[geom]) in bodies:
            return
    raise BadModel(
        f"no shape of the arm of {path} can touch anything: add geoms that collide (contype=1), such as "
        "a capsule for each link"
    )


def check_size(
    model: mujoco.MjModel, joints: Sequence[str], home: Sequence[float], site: str, path: FilePath
) -> None:
    """Raise BadModel if lengths are not in m."""
    data = mujoco.MjData(model)
    for name, angle in zip(joints, home, strict=True):
        data.joint(name).qpos[0] = angle
    mujoco.mj_kinematics(model, data)
    links = [data.xanchor[model.joint(name).id] for name in joints] + [data.site(site).xpos]
    steps = [links[i + 1] - links[i] for i in range(len(links) - 1)]
    length = float(sum((step @ step) ** 0.5 for step in steps))
    if not SHORTEST < length < LONGEST:
        raise BadModel(
            f"the arm of {path} is {length:.3g} m long from its first joint to {site!r}: lengths must be "
            "in m, not in mm"
        )
    for geom in range(model.ngeom):
        radius, body = float(model.geom_rbound[geom]), int(model.geom_bodyid[geom])
        if radius > LONGEST and model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = model.mesh(int(model.geom_dataid[geom])).name
            raise BadModel(
                f"mesh {mesh!r} of body {model.body(body).name!r} of {path} is {2 * radius:.0f} m large: "
                'if it is in mm, add scale="0.001 0.001 0.001" to the mesh'
            )
