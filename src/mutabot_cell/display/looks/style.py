"""Materials, and helpers that add shapes which are only visual."""

from __future__ import annotations

import mujoco

from mutabot_cell.parts import Vector3

#: groups of shapes: those that are drawn instead of simulated ones, and the simulated ones they stand for
LOOKS, HIDDEN = 2, 3
#: before names of what is added
_ADDED = "look of "

BOX, CYLINDER, CAPSULE = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_CAPSULE,
)

#: red, green, blue; how much it mirrors light, how sharply, and how much of the room
_MATERIALS = {
    "aluminium": ((0.74, 0.75, 0.77), 0.7, 0.55, 0.0),
    "steel": ((0.52, 0.53, 0.55), 0.8, 0.7, 0.0),
    "anthracite": ((0.17, 0.18, 0.20), 0.35, 0.35, 0.0),
    "black": ((0.12, 0.12, 0.13), 0.45, 0.45, 0.0),
    "belt": ((0.15, 0.16, 0.17), 0.15, 0.12, 0.0),
    "seam": ((0.24, 0.25, 0.26), 0.1, 0.1, 0.0),
    "shell": ((0.88, 0.885, 0.895), 0.4, 0.6, 0.0),
    "ring": ((0.20, 0.21, 0.23), 0.4, 0.5, 0.0),
    "blue": ((0.05, 0.27, 0.52), 0.4, 0.5, 0.0),
    "paper": ((0.95, 0.95, 0.93), 0.05, 0.1, 0.0),
    "ink": ((0.07, 0.07, 0.08), 0.05, 0.1, 0.0),
    "yellow": ((0.95, 0.74, 0.07), 0.3, 0.4, 0.0),
    "red": ((0.75, 0.06, 0.05), 0.4, 0.5, 0.0),
    "lamp": ((0.15, 0.75, 0.30), 0.4, 0.5, 0.0),
}


def named(name: str) -> str:
    """Return the name for an added shape, different from all simulated names."""
    return _ADDED + name


def is_added(name: str) -> bool:
    """Return whether a name is that of an added shape."""
    return name.startswith(_ADDED)


def add_materials(spec: mujoco.MjSpec) -> None:
    """Add all materials, by the names that `show` takes."""
    for name, ((red, green, blue), specular, shininess, reflectance) in _MATERIALS.items():
        spec.add_material(
            name=named(name),
            rgba=(red, green, blue, 1.0),
            specular=specular,
            shininess=shininess,
            reflectance=reflectance,
        )


def show(
    body: mujoco.MjsBody,
    kind: mujoco.mjtGeom,
    size: Vector3,
    pos: Vector3 = (0.0, 0.0, 0.0),
    *,
    material: str = "",
    rgba: tuple[float, ...] | None = None,
    quat: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0),
) -> mujoco.MjsGeom:
    """Add a shape without contacts and mass; half edges, or radius and half length, m."""
    geom = body.add_geom(
        type=kind, size=size, pos=pos, quat=quat, contype=0, conaffinity=0, mass=0.0, group=LOOKS
    )
    if material:
        geom.material = named(material)
    if rgba is not None:
        geom.rgba = rgba
    return geom


def hide(geom: mujoco.MjsGeom) -> None:
    """Hide a shape that another one replaces."""
    geom.group = HIDDEN


#: turns the axis of a cylinder from z to x, and to y
ALONG_X, ALONG_Y = (0.7071067811865476, 0.0, 0.7071067811865476, 0.0), (
    0.7071067811865476, 0.7071067811865476, 0.0, 0.0,
)  # fmt: skip
