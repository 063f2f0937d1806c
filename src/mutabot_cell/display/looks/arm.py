"""Draws the Gen3's links with its maker's meshes, which robosuite provides."""

from __future__ import annotations

import mujoco

from .packages import folder_of, show_mesh
from .style import hide

#: by the body of the arm that shows it
_LINKS = {
    "base": "base_link",
    "link 1": "shoulder_link",
    "link 2": "half_arm_1_link",
    "link 3": "half_arm_2_link",
    "link 4": "forearm_link",
    "link 5": "spherical_wrist_1_link",
    "link 6": "spherical_wrist_2_link",
    "link 7": "bracelet_with_vision_link",
}


def dress_gen3(spec: mujoco.MjSpec, prefix: str) -> None:
    """Draw the links' meshes if there is a Gen3 and its meshes are installed."""
    bodies = {name: spec.body(prefix + name) for name in _LINKS}
    meshes = folder_of("robosuite", "models/assets/robots/kinova3/meshes")
    if meshes is None or None in bodies.values():
        return
    for name, mesh in _LINKS.items():
        body = bodies[name]
        for geom in list(body.geoms):
            hide(geom)
        show_mesh(spec, body, meshes / f"{mesh}.stl", "shell")
