"""Finds meshes in other packages, if these are installed."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import mujoco

from mutabot_cell.parts import Vector3

from .style import LOOKS, named


def folder_of(package: str, inside: str) -> Path | None:
    """Return a folder inside a package, without importing it; None if it is not installed."""
    found = find_spec(package)
    for place in (found.submodule_search_locations or ()) if found is not None else ():
        if (path := Path(place, inside)).is_dir():
            return path
    return None


def show_mesh(
    spec: mujoco.MjSpec, body: mujoco.MjsBody, file: Path, material: str, *, scale: Vector3 = (1.0, 1.0, 1.0)
) -> mujoco.MjsGeom:
    """Draw a mesh file in a body's frame; it is loaded once for all bodies that use it.

    Args:
        scale: m per unit of the file, along each axis.
    """
    name = named(file.as_posix())
    if spec.mesh(name) is None:
        spec.add_mesh(
            name=name, file=str(file), scale=scale, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        )
    return body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        material=named(material),
        contype=0,
        conaffinity=0,
        mass=0.0,
        group=LOOKS,
    )
