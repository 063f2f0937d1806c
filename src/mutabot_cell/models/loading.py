"""Loads robots from MuJoCo files: the chain of joints to the flange, servos, and colliding shapes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path

import mujoco

from mutabot_cell.errors import BadArgument, BadModel
from mutabot_cell.geometry import Pose, pose_of

from .checks import check_chain, check_masses, check_size, check_touch, compiled
from .limits import JointLimits, Limits
from .servos import make_servos, servos_of, torque_of
from .stripping import ARM_CLASS, collide_as, freeze_inertias, remove_visuals, strip


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ArmModel:
    """An arm without a tool, as described by a file.

    Attributes:
        name: of the robot's type.
        spec: the arm; its world frame is the robot's base frame.
        joints: names of the joints from the base to the flange; each turns about one axis.
        servos: names of the position servos of these joints.
        home: joint angles of the home position, rad.
        ranges: lowest and highest angle of each joint, rad; infinite for one that turns without end.
        limits: what the joints may do.
        flange: name of the site to which tools are fastened; its z axis points away from the arm.
        base: where the base stands in the file's world, m and degrees; None where that world is the base.
        root: name of its first body in a file that holds more than the robot; "" otherwise.
        file: that it was read from, for pictures: it may hold meshes that the simulation leaves out.
    """

    name: str
    spec: mujoco.MjSpec
    joints: tuple[str, ...]
    servos: tuple[str, ...]
    home: tuple[float, ...]
    ranges: tuple[tuple[float, float], ...]
    limits: JointLimits
    flange: str
    base: Pose | None = None
    root: str = ""
    file: Path | None = None


def read_mjcf(
    path: str | PathLike[str],
    tool_site: str,
    home: Sequence[float] | None,
    limits: Limits,
    root: str | None,
    without: Sequence[str],
) -> ArmModel:
    """Read an arm from a file in MuJoCo's format; see `RobotModel.from_mjcf`."""
    spec = read(path)
    base = None
    if root is not None:
        spec, base = _part(spec, root, path)
    for name in without:
        part = spec.body(name) or spec.geom(name)
        if part is None:
            raise BadModel(
                f"{path} has no body or geom {name!r} to leave out; it has {names_of(spec.bodies)}"
            )
        spec.delete(part)
    return read_spec(spec, path, tool_site, home, limits, base, root or "")


def read(path: str | PathLike[str]) -> mujoco.MjSpec:
    """Return the spec of a file. Raises BadModel if MuJoCo cannot read it."""
    if not Path(path).is_file():
        raise BadModel(f"there is no file {fspath(path)!r}")
    try:
        return mujoco.MjSpec.from_file(fspath(path))
    except (ValueError, mujoco.FatalError) as error:
        raise BadModel(f"MuJoCo cannot read {path}: {error}") from error


def flange_of(spec: mujoco.MjSpec, path: str | PathLike[str], tool_site: str) -> mujoco.MjsSite:
    """Return the site of this name, or make it in the body of this name. Raises BadModel without either."""
    flange = spec.site(tool_site)
    if flange is None and spec.body(tool_site) is not None:
        flange = spec.body(tool_site).add_site(name=tool_site)
    if flange is None:
        raise BadModel(
            f"{path} has no site or body {tool_site!r}; it has the sites {names_of(spec.sites)}. Add "
            f'<site name="{tool_site}"/> to the last link, its z axis pointing away from the arm'
        )
    return flange


def read_spec(
    spec: mujoco.MjSpec,
    path: str | PathLike[str],
    tool_site: str,
    home: Sequence[float] | None,
    limits: Limits,
    base: Pose | None = None,
    root: str = "",
) -> ArmModel:
    """Read an arm from a spec that contains nothing else. Changes the spec."""
    flange = flange_of(spec, path, tool_site)
    chain = chain_to(flange.parent, spec)
    joints = check_chain(chain, path)
    keys = {key.name: list(key.qpos) for key in spec.keys}
    names = tuple(joint.name for joint in joints)
    angles = _home(home, keys, len(names), len(list(spec.joints)), path)
    strip(spec)
    remove_visuals(spec)
    model = compiled(spec, path)
    check_masses(model, names, path)
    check_touch(model, chain, path)
    resolved = limits.of_joints(names, [torque_of(spec, model, name) for name in names])
    servos = servos_of(spec, names) or make_servos(spec, names, resolved)
    freeze_inertias(spec, model)
    remove_visuals(spec)
    collide_as(spec, ARM_CLASS)
    for body in chain:
        body.gravcomp = 1.0
    for joint in joints:
        joint.actgravcomp = True
    ranges = tuple(_range(model, name) for name in names)
    _check_home(angles, ranges, names, path)
    check_size(compiled(spec, path), names, angles, tool_site, path)
    return ArmModel(
        name=Path(path).stem,
        spec=spec,
        joints=names,
        servos=servos,
        home=angles,
        ranges=ranges,
        limits=resolved,
        flange=tool_site,
        root=root,
        base=base,
        file=Path(path),
    )


def chain_to(body: mujoco.MjsBody, spec: mujoco.MjSpec) -> list[mujoco.MjsBody]:
    """Return the bodies from the base to `body`."""
    chain = []
    while body is not None and body != spec.worldbody:
        chain.append(body)
        body = body.parent
    return chain[::-1]


def _part(spec: mujoco.MjSpec, root: str, path: str | PathLike[str]) -> tuple[mujoco.MjSpec, Pose]:
    """Return the robot that begins with body `root`, alone, and its pose in the file's world."""
    body = spec.body(root)
    if body is None:
        raise BadModel(f"{path} has no body {root!r} for the robot's base; it has {names_of(spec.bodies)}")
    model = compiled(spec, path)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    number = model.body(root).id
    base = pose_of(data.xpos[number], data.xmat[number].reshape(3, 3))
    alone = mujoco.MjSpec()
    moved = alone.worldbody.add_frame().attach_body(body, "", "")
    moved.pos, moved.quat = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
    return alone, base


def _home(
    home: Sequence[float] | None,
    keys: dict[str, list[float]],
    count: int,
    all_joints: int,
    path: str | PathLike[str],
) -> tuple[float, ...]:
    if home is None:
        found = keys.get("home") or next(iter(keys.values()), None)
        if found is None or all_joints != count:
            raise BadModel(
                f"{path} has no keyframe for the joints of the arm alone: say home=[...], {count} angles in "
                "degrees"
            )
        return tuple(found)
    if len(home) != count or not all(isinstance(a, (int, float)) and math.isfinite(a) for a in home):
        raise BadArgument(f"Expected {count} angles in degrees, one per joint, but got home={home!r}")
    return tuple(math.radians(angle) for angle in home)


def _range(model: mujoco.MjModel, name: str) -> tuple[float, float]:
    joint = model.joint(name)
    low, high = joint.range.tolist() if joint.limited[0] else (-math.inf, math.inf)
    return low, high


def _check_home(
    angles: tuple[float, ...],
    ranges: tuple[tuple[float, float], ...],
    names: tuple[str, ...],
    path: str | PathLike[str],
) -> None:
    for angle, (low, high), name in zip(angles, ranges, names, strict=True):
        if not low <= angle <= high:
            bounds = ", ".join(f"{math.degrees(bound):.1f}" for bound in (low, high))
            raise BadArgument(
                f"home puts joint {name!r} of {path} at {math.degrees(angle):.1f} deg, out of {bounds} deg"
            )


def names_of(elements: Iterable[object]) -> str:
    """Return the elements' names for a message."""
    found = [str(getattr(element, "name", "")) for element in elements]
    return ", ".join(repr(name) for name in found if name) or "none with a name"
