"""Removes from a model file what a cell does not need: visuals, and parts of other worlds."""

from __future__ import annotations

import math

import mujoco

ARM_CLASS, GRIPPER_CLASS = 2, 4
"""`contype` of arm and gripper: see `options.DEFAULTS`."""
_TOUCH = {ARM_CLASS: 13, GRIPPER_CLASS: 11}
"""`conaffinity`: neither touches itself."""


def strip(spec: mujoco.MjSpec) -> None:
    """Remove keyframes, sensors, lights and cameras, since the cell has its own."""
    for element in (*spec.keys, *spec.sensors, *spec.lights, *spec.cameras):
        spec.delete(element)


def freeze_inertias(spec: mujoco.MjSpec, model: mujoco.MjModel) -> None:
    """Write the masses that the compiler has computed into the bodies, so that shapes can be removed."""
    for body in spec.bodies:
        if body == spec.worldbody or body.id < 0:
            continue
        body.mass = float(model.body_mass[body.id])
        body.ipos, body.iquat = model.body_ipos[body.id], model.body_iquat[body.id]
        body.inertia, body.fullinertia = model.body_inertia[body.id], (math.nan,) * 6
        body.ialt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
        body.explicitinertial = True


def remove_visuals(spec: mujoco.MjSpec) -> None:
    """Remove shapes without contacts and mass, and unused meshes, because they are slow."""
    for geom in list(spec.geoms):
        if not geom.contype and not geom.conaffinity and geom.parent.explicitinertial:
            spec.delete(geom)
    used = {geom.meshname for geom in spec.geoms}
    for mesh in list(spec.meshes):
        if mesh.name not in used:
            spec.delete(mesh)


def collide_as(spec: mujoco.MjSpec, collision_class: int) -> None:
    """Put all colliding shapes into one of the cell's classes, and make them visible."""
    for geom in spec.geoms:
        if geom.contype or geom.conaffinity:
            geom.contype, geom.conaffinity, geom.group = collision_class, _TOUCH[collision_class], 0
