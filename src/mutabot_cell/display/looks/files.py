"""Draws arms and tools with the meshes of their files, which the simulation does not load."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import mujoco

from .style import LOOKS, hide, named


def dress_from_file(spec: mujoco.MjSpec, prefix: str, file: Path | None) -> None:
    """Draw the meshes of a file instead of the simulated shapes.

    Args:
        prefix: what stands in `spec` before the names of the file's bodies.
        file: in MuJoCo's format; None for what was built otherwise.
    """
    if file is None or file.suffix != ".xml" or not file.is_file():
        return
    source = _read(file)
    for body in source.bodies:
        shown = [geom for geom in body.geoms if _is_looked_at(geom)]
        there = spec.body(prefix + body.name) if body.name else None
        if not shown or there is None:
            continue
        for geom in list(there.geoms):
            hide(geom)
        for geom in shown:
            _copy(spec, there, source, geom, f"{prefix}{file.parent.name}/")


@cache
def _read(file: Path) -> mujoco.MjSpec:
    return mujoco.MjSpec.from_file(str(file))


def _is_looked_at(geom: mujoco.MjsGeom) -> bool:
    """Return whether a shape is a mesh without contacts."""
    return not geom.contype and not geom.conaffinity and geom.type == mujoco.mjtGeom.mjGEOM_MESH


def _copy(
    spec: mujoco.MjSpec, body: mujoco.MjsBody, source: mujoco.MjSpec, geom: mujoco.MjsGeom, prefix: str
) -> None:
    mesh = source.mesh(geom.meshname)
    name = named(prefix + mesh.name)
    if spec.mesh(name) is None:
        spec.add_mesh(
            name=name,
            file=str(Path(source.modelfiledir, source.meshdir, mesh.file)),
            scale=mesh.scale,
            refpos=mesh.refpos,
            refquat=mesh.refquat,
            smoothnormal=mesh.smoothnormal,
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )
    material = source.material(geom.material) if geom.material else None
    copied = body.add_geom(
        type=geom.type,
        meshname=name,
        pos=geom.pos,
        quat=geom.quat,
        rgba=material.rgba if material is not None else geom.rgba,
        contype=0,
        conaffinity=0,
        mass=0.0,
        group=LOOKS,
    )
    copied.alt = geom.alt
