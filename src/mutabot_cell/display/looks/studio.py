"""The floor, sky and lights of pictures, and their quality."""

from __future__ import annotations

import mujoco

from .style import named

_ENDLESS = (0.0, 0.0, 0.05)


def add_lights(spec: mujoco.MjSpec) -> None:
    """Add a key light that casts shadows, a fill light and a back light that outlines edges."""
    _quality(spec)
    _floor(spec)
    lights = (
        ("key", (1.6, -1.8, 4.2), (-0.36, 0.42, -1.0), 0.62, 0.40, True),
        ("fill", (3.0, 3.0, 3.0), (-0.8, -0.7, -0.65), 0.17, 0.0, False),
        ("rim", (-3.0, 1.0, 3.5), (0.85, -0.25, -0.75), 0.24, 0.45, False),
    )
    for name, place, along, bright, shine, casts in lights:
        spec.worldbody.add_light(
            name=named(name),
            type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
            pos=place,
            dir=along,
            diffuse=(bright, bright, bright),
            specular=(shine, shine, shine),
            ambient=(0.0, 0.0, 0.0),
            castshadow=casts,
        )


def _quality(spec: mujoco.MjSpec) -> None:
    visual = spec.visual
    visual.quality.shadowsize, visual.quality.offsamples = 8192, 8
    visual.headlight.ambient[:] = (0.29, 0.29, 0.30)
    visual.headlight.diffuse[:] = (0.10, 0.10, 0.10)
    visual.headlight.specular[:] = (0.0, 0.0, 0.0)
    visual.rgba.haze[:] = (0.86, 0.88, 0.90, 1.0)
    visual.map.haze, visual.map.znear, visual.map.zfar = 0.75, 0.01, 40.0
    visual.map.shadowclip = 1.6
    spec.stat.extent, spec.stat.center = 1.6, (0.1, 0.0, 0.9)
    visual.global_.offwidth, visual.global_.offheight = 1280, 960


def _floor(spec: mujoco.MjSpec) -> None:
    spec.add_texture(
        name=named("sky"),
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=(0.66, 0.72, 0.79),
        rgb2=(0.86, 0.88, 0.90),
        width=256,
        height=1536,
    )
    spec.add_texture(
        name=named("tiles"),
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=(0.60, 0.615, 0.63),
        rgb2=(0.60, 0.615, 0.63),
        markrgb=(0.52, 0.53, 0.55),
        width=512,
        height=512,
    )
    floor = spec.add_material(name=named("floor"), reflectance=0.1, specular=0.1, shininess=0.2)
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = named("tiles")
    floor.texrepeat[:] = (1.0, 1.0)
    floor.texuniform = True
    plane = spec.geom("floor")
    plane.size, plane.material = _ENDLESS, named("floor")
