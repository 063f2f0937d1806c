"""Parallel grippers from MuJoCo files: the fingers' properties are measured by moving them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from os import PathLike

import mujoco
import numpy as np

from mutabot_cell.errors import BadArgument, BadModel
from mutabot_cell.geometry import Array

from .checks import compiled
from .effectors import Fingers
from .loading import names_of, read
from .options import PHYSICS_STEP
from .stripping import GRIPPER_CLASS, collide_as, freeze_inertias, remove_visuals, strip

PREFIX = "tool/"
"""Before the names of a tool's file, so that they do not meet those of the arm's."""
_POINTS = 9
"""At which the way of the fingers is measured: on linkages they do not move as evenly as their motor."""
_MOVING_TIME = 1.0
"""In which fingers go from one of them to the next for sure, s."""
_WEAKEST_SHARE = 0.1
_SPEED_RANGE, _SPEED = (0.001, 0.2), 0.1
"""How fast fingers may be, and are unless said otherwise, m/s (our choice)."""


@dataclass(frozen=True, slots=True)
class _RestingFingers:
    """Fingers at rest: input and measurement of the servo, the gap between the pads (m), their centre (m)."""

    control: float
    length: float
    gap: float
    middle: Array


@dataclass(frozen=True, slots=True)
class GripperFile:
    """The description of a gripper in a file.

    Attributes:
        spec, body, point: as in `Tool`.
        fingers: what they do, as measured.
    """

    spec: mujoco.MjSpec
    body: str
    point: tuple[float, float, float]
    fingers: Fingers


def read_gripper(
    path: str | PathLike[str],
    actuator: str,
    controls: tuple[float, float],
    pads: tuple[str, ...],
    point: str | None,
    force: float | None,
) -> GripperFile:
    """Read a gripper from a file in MuJoCo's format and measure its fingers; see `Tool.from_mjcf`."""
    spec = read(path)
    strip(spec)
    remove_visuals(spec)
    model = compiled(spec, path)
    _check_names(spec, path, actuator, pads, point)
    freeze_inertias(spec, model)
    remove_visuals(spec)
    collide_as(spec, GRIPPER_CLASS)
    for body in spec.bodies:
        if body != spec.worldbody:
            body.gravcomp = 1.0
    model = compiled(spec, path)
    found = _moved(model, actuator, np.linspace(*controls, _POINTS).tolist(), pads)
    opened, closed = found[0], found[-1]
    stroke, travel = opened.gap - closed.gap, closed.length - opened.length
    steps = [after.gap - before.gap for before, after in pairwise(found)]
    if stroke < 1e-3 or abs(travel) < 1e-9 or max(steps) >= 0:
        raise BadModel(
            f"the pads of {path} are {opened.gap * 1000:.1f} mm apart with {actuator!r} at {controls[0]} "
            f"(open) and {closed.gap * 1000:.1f} mm at {controls[1]} (closed): "
            "open must be the input that opens"
        )
    # what the servo does over its way, both pads do over the stroke
    ratio = stroke / abs(travel)
    number = model.actuator(actuator).id
    if not model.actuator_forcelimited[number]:
        raise BadModel(
            f"actuator {actuator!r} of {path} has no forcerange: add it, it decides the grip force"
        )
    strongest = float(model.actuator_forcerange[number, 1]) / ratio
    if force is not None and not 0 < force <= strongest:
        raise BadArgument(
            f"Expected 0 < force <= {strongest:.0f} N, what {actuator!r} of {path} gives at the pads, "
            f"but got force={force!r}"
        )
    first = PREFIX + next(iter(spec.worldbody.bodies)).name
    place = closed.middle if point is None else _site_place(model, point)
    return GripperFile(
        spec=_prefixed(spec),
        body=first,
        point=(float(place[0]), float(place[1]), float(place[2])),
        fingers=Fingers(
            actuator=PREFIX + actuator,
            pads=tuple(PREFIX + pad for pad in pads),
            stroke=stroke,
            paths=tuple(opened.gap - fingers.gap for fingers in found),
            controls=tuple(fingers.control for fingers in found),
            lengths=tuple(fingers.length for fingers in found),
            force_range=(_WEAKEST_SHARE * strongest, strongest),
            speed_range=_SPEED_RANGE,
            force=strongest if force is None else force,
            speed=_SPEED,
            force_ratio=ratio,
        ),
    )


def _prefixed(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """Return a copy with `PREFIX` before all names."""
    whole = mujoco.MjSpec()
    whole.attach(spec, frame=whole.worldbody.add_frame(), prefix=PREFIX)
    return whole


def _check_names(
    spec: mujoco.MjSpec, path: str | PathLike[str], actuator: str, pads: tuple[str, ...], point: str | None
) -> None:
    if spec.actuator(actuator) is None:
        raise BadModel(
            f"{path} has no actuator {actuator!r} for the fingers; it has {names_of(spec.actuators)}"
        )
    for pad in pads:
        if spec.geom(pad) is None:
            raise BadModel(
                f"{path} has no geom {pad!r} for a pad; it has {names_of(spec.geoms)}. Add name=... to the "
                "shapes that touch what is gripped"
            )
    if len(pads) < 2:
        raise BadArgument(f"Expected pads on both sides but got pads={pads!r}")
    if point is not None and spec.site(point) is None:
        raise BadModel(f"{path} has no site {point!r} for the tool point; it has {names_of(spec.sites)}")


def _moved(
    model: mujoco.MjModel, actuator: str, controls: Sequence[float], pads: tuple[str, ...]
) -> list[_RestingFingers]:
    """Return the fingers at rest for each of these inputs in turn, without gravity."""
    model.opt.gravity[:] = 0
    model.opt.timestep = PHYSICS_STEP
    data = mujoco.MjData(model)
    number = model.actuator(actuator).id
    found = []
    for control in controls:
        data.ctrl[number] = control
        for _ in range(round(_MOVING_TIME / PHYSICS_STEP)):
            mujoco.mj_step(model, data)
        places = [data.geom_xpos[model.geom(pad).id] for pad in pads]
        gap = min(distance_between(model, data, pads[0], other) for other in _opposite(places, pads))
        found.append(
            _RestingFingers(control, float(data.actuator_length[number]), gap, np.mean(places, axis=0))
        )
    return found


def _opposite(places: Sequence[Array], pads: Sequence[str]) -> list[str]:
    """Return the pads on the other side than the first: those that are nearer to the one furthest away."""
    away = [float(np.linalg.norm(place - places[0])) for place in places]
    furthest = places[int(np.argmax(away))]
    return [
        pad
        for pad, place, distance in zip(pads, places, away, strict=True)
        if float(np.linalg.norm(place - furthest)) < distance
    ]


def distance_between(model: mujoco.MjModel, data: mujoco.MjData, first: str, second: str) -> float:
    """Return the distance between two shapes, m, at most 1; negative if they overlap."""
    between = np.zeros(6)
    numbers = model.geom(first).id, model.geom(second).id
    return float(mujoco.mj_geomDistance(model, data, *numbers, 1.0, between))


def _site_place(model: mujoco.MjModel, site: str) -> Array:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    place: Array = data.site_xpos[model.site(site).id].copy()
    return place
