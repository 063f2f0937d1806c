"""Loads scenes from MuJoCo files: named bodies and shapes become fixtures and parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import mujoco

from mutabot_cell.errors import BadModel
from mutabot_cell.geometry import Array, euler_from_rotation
from mutabot_cell.parts import Box, Cylinder, Part, Vector3

from .checks import FilePath, compiled
from .loading import names_of, read

_BOX, _CYLINDER = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER


class FixedBox(NamedTuple):
    """A box that never moves; its fields are the first of `Fixture`."""

    name: str
    size: Vector3
    centre: Vector3
    rgba: tuple[float, float, float, float]
    friction: float
    angles: Vector3


def read_scene(
    path: FilePath, parts: Sequence[str], fixtures: Sequence[str]
) -> tuple[tuple[Part, ...], tuple[FixedBox, ...]]:
    """Read parts, and boxes for fixtures, from a file in MuJoCo's format; see `Scene.from_mjcf`."""
    spec = read(path)
    model = compiled(spec, path)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    shapes = {name: _shape_of(spec, model, name, path) for name in (*parts, *fixtures)}
    boxes = tuple(_fixed_box(model, data, name, shapes[name], path) for name in fixtures)
    return tuple(_part(model, data, name, shapes[name], path) for name in parts), boxes


def _shape_of(spec: mujoco.MjSpec, model: mujoco.MjModel, name: str, path: FilePath) -> int:
    """Return the index of the only colliding shape of a body, or of the named shape."""
    if spec.body(name) is not None:
        body = model.body(name).id
        found = [
            geom for geom in range(model.ngeom) if model.geom_bodyid[geom] == body and _touches(model, geom)
        ]
        if len(found) != 1:
            what = f"{len(found)} shapes that collide; Scene takes one: leave contype=1 on a single geom"
            raise BadModel(f"body {name!r} of {path} has {what}")
        return found[0]
    if spec.geom(name) is None:
        raise BadModel(f"{path} has no body or geom {name!r}; bodies: {names_of(spec.bodies)}")
    return int(model.geom(name).id)


def _touches(model: mujoco.MjModel, geom: int) -> bool:
    return bool(model.geom_contype[geom] or model.geom_conaffinity[geom])


def _fixed_box(model: mujoco.MjModel, data: mujoco.MjData, name: str, geom: int, path: FilePath) -> FixedBox:
    if model.geom_type[geom] != _BOX:
        raise BadModel(f"fixture {name!r} of {path} is not a box: give it a geom of type box")
    return FixedBox(
        name,
        _triple(2 * model.geom_size[geom]),
        _triple(data.geom_xpos[geom]),
        tuple(model.geom_rgba[geom].tolist()),
        float(model.geom_friction[geom, 0]),
        euler_from_rotation(data.geom_xmat[geom].reshape(3, 3)),
    )


def _part(model: mujoco.MjModel, data: mujoco.MjData, name: str, geom: int, path: FilePath) -> Part:
    body = int(model.geom_bodyid[geom])
    mass, size = float(model.body_mass[body]), model.geom_size[geom]
    if body == 0 or mass <= 0.0:
        raise BadModel(f"part {name!r} of {path} does not weigh anything: make it a body with a mass (kg)")
    angles = euler_from_rotation(data.geom_xmat[geom].reshape(3, 3))
    part: Part
    if model.geom_type[geom] == _BOX:
        part = Box(name=name, size=_triple(2 * size), mass=mass, angles=angles)
    elif model.geom_type[geom] == _CYLINDER:
        diameter, height = (float(length) for length in 2 * size[:2])
        part = Cylinder(name=name, diameter=diameter, height=height, mass=mass, angles=angles)
    else:
        raise BadModel(
            f"part {name!r} of {path} is neither a box nor a cylinder: give it such a geom, or use Mesh"
        )
    x, y, z = _triple(data.geom_xpos[geom])
    return replace(part, position=(x, y, z - part.middle_height), rgba=tuple(model.geom_rgba[geom].tolist()))


def _triple(values: Array) -> Vector3:
    x, y, z = values.tolist()
    return x, y, z
