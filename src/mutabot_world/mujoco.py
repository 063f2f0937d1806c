"""Disturbances for any program that uses MuJoCo: the functions that ``mujoco.toml`` names.

Each is a function of a model as it was made, of the change in SI units and, by name, of ``names``, in which
``*`` stands for any text. A model that tests share stays changed as long as the process of the test lives.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from fnmatch import fnmatchcase
from random import Random
from typing import Any

import wrapt

from .change import NotInWorldError, NumberChange
from .patching import mark_raised, rebind

_LEAST = 1e-9
_AXES = "xyz"
#: what lets a state follow a model, so that positions are to be right when it begins
_STEPS = ("mj_step", "mj_step1", "mj_forward")


def mass(model: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the mass of bodies, kg, with their inertia."""
    for body in _named(model, "body", names, lambda number: model.body_mass[number] > 0.0):
        before = float(model.body_mass[body])
        factor = max(float(change(before)), _LEAST) / before
        model.body_mass[body] *= factor
        model.body_inertia[body] *= factor
    _recompute_constants(model)


def centre_of_mass(model: Any, change: NumberChange, *, names: str, random: Random, axis: str) -> None:
    """Change the centre of mass of bodies along one of their axes, m."""
    bodies = list(_named(model, "body", names, lambda number: model.body_mass[number] > 0.0))
    if hasattr(model, "body_simple") and any(model.body_simple[body] for body in bodies):
        raise NotInWorldError(
            f"the body {names!r} was compiled as a simple one, whose centre of mass is fixed"
        )
    for body in bodies:
        place = model.body_ipos[body]
        place[_AXES.index(axis)] = change(float(place[_AXES.index(axis)]))
    _recompute_constants(model)


def friction(model: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the sliding friction of shapes, and of explicit contact pairs, which take precedence."""
    geoms = set(_named(model, "geom", names))
    for geom in geoms:
        model.geom_friction[geom, 0] = max(float(change(float(model.geom_friction[geom, 0]))), 1e-5)
    for pair in range(model.npair):
        if geoms & {int(model.pair_geom1[pair]), int(model.pair_geom2[pair])}:
            model.pair_friction[pair, :2] = [
                max(float(change(float(x))), 1e-5) for x in model.pair_friction[pair, :2]
            ]


def position(model: Any, change: NumberChange, *, names: str, random: Random, axis: str) -> None:
    """Change the position of bodies in their parent's frame, m; also after a framework has moved them."""
    number, written = _AXES.index(axis), dict[int, float]()
    bodies = list(_named(model, "body", names, lambda body: body > 0))

    def move() -> None:
        for body in bodies:
            now = float(model.body_pos[body][number])
            if written.get(body) != now:
                model.body_pos[body][number] = written[body] = float(change(now))

    move()
    _around_steps(model, _STEPS, before=move)


def gain(model: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the gain of actuators, and the stiffness of those that are servos."""
    for actuator in _named(model, "actuator", names):
        before = float(model.actuator_gainprm[actuator, 0])
        model.actuator_gainprm[actuator, 0] = change(before)
        if float(model.actuator_biasprm[actuator, 1]) == -before:  # a servo for positions
            model.actuator_biasprm[actuator, 1] = -change(before)


def strength(model: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the largest force of actuators, N or Nm, of those that have a limit."""
    for actuator in _named(model, "actuator", names, lambda index: bool(model.actuator_forcelimited[index])):
        model.actuator_forcerange[actuator] = change(model.actuator_forcerange[actuator])


def damping(model: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the damping of joints, N·s/m or N·m·s/rad."""
    _of_joints(model, change, names, model.dof_damping)


def joint_friction(model: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the dry friction of joints, N or Nm."""
    _of_joints(model, change, names, model.dof_frictionloss)


def gravity(model: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the vertical gravity, m/s²; a positive change pulls harder."""
    model.opt.gravity[2] = -float(change(-float(model.opt.gravity[2])))


def sensor(model: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change what sensors of a model read, in their own units."""
    parts = [
        slice(int(model.sensor_adr[index]), int(model.sensor_adr[index] + model.sensor_dim[index]))
        for index in _named(model, "sensor", names)
    ]

    def read(data: Any) -> None:
        for part in parts:
            data.sensordata[part] = change(data.sensordata[part])

    _around_steps(model, ("mj_step", "mj_forward"), after=read)


def names_of(model: Any, kind: str) -> dict[int, str]:
    """Return the names of a model's bodies, geoms, joints, actuators or sensors, by their numbers.

    A shape without a name is called like its body, an actuator like what it drives.
    """
    count = {"body": "nbody", "geom": "ngeom", "joint": "njnt", "actuator": "nu", "sensor": "nsensor"}[kind]
    known = {number: str(getattr(model, kind)(number).name) for number in range(getattr(model, count))}
    for number in [number for number, name in known.items() if not name]:
        if kind == "geom":
            known[number] = str(model.body(model.geom_bodyid[number]).name)
        elif kind == "actuator" and int(model.actuator_trntype[number]) in (0, 1):  # of joints
            known[number] = str(model.joint(model.actuator_trnid[number, 0]).name)
    return known


def offered_parameters(model: Any) -> Iterator[tuple[str, list[str]]]:
    """Yield the parameters that a model offers, and the names of the things that have them."""
    bodies, geoms, joints = names_of(model, "body"), names_of(model, "geom"), names_of(model, "joint")
    free = [int(model.jnt_bodyid[n]) for n in range(model.njnt) if int(model.jnt_type[n]) == 0]
    yield "mass", [bodies[n] for n in free]
    yield "friction", [geoms[n] for n in range(model.ngeom) if int(model.geom_bodyid[n]) in free]
    yield "gain", [*names_of(model, "actuator").values()]
    damped = [n for n in range(model.njnt) if float(model.dof_damping[model.jnt_dofadr[n]]) > 0.0]
    yield "damping", [joints[n] for n in damped if int(model.jnt_type[n]) in (2, 3)]
    yield "gravity", ["*"] if float(model.opt.gravity[2]) else []


def _of_joints(model: Any, change: NumberChange, names: str, values: Any) -> None:
    for joint in _named(model, "joint", names, lambda index: int(model.jnt_type[index]) in (2, 3)):
        dof = int(model.jnt_dofadr[joint])  # the one of a slide or a hinge
        values[dof] = max(float(change(float(values[dof]))), 0.0)
    _recompute_constants(model)


def _named(
    model: Any, kind: str, names: str, fits: Callable[[int], bool] = lambda number: True
) -> Iterator[int]:
    """Yield the numbers of the things named. Raises NotInWorldError if there are none."""
    known = names_of(model, kind)
    found = [number for number, name in known.items() if fnmatchcase(name, names) and fits(number)]
    if not found:
        there = ", ".join(sorted({name for number, name in known.items() if name and fits(number)})) or "none"
        raise NotInWorldError(f"no {kind} is named {names!r}; there are: {there}")
    yield from found


def _recompute_constants(model: Any) -> None:
    """Recompute the model's derived constants; the program's own data would lose its state."""
    import mujoco  # noqa: PLC0415  # the program's, which a project may not have

    mujoco.mj_setConst(model, mujoco.MjData(model))


def _around_steps(model: Any, names: Iterable[str], *, before: Any = None, after: Any = None) -> None:
    """Call functions before MuJoCo's stepping functions run on a model, and with its data after them."""
    import mujoco  # noqa: PLC0415  # the program's, which a project may not have

    def around(wrapped: Any, _: Any, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
        is_meant = (arguments[0] if arguments else named.get("m")) is model
        if is_meant and before is not None:
            before()
        try:
            result = wrapped(*arguments, **named)
        except Exception as error:
            mark_raised(error)
            raise
        if is_meant and after is not None:
            after(arguments[1] if len(arguments) > 1 else named["d"])
        return result

    for name in names:
        function = getattr(mujoco, name)
        rebind(function, wrapt.FunctionWrapper(function, around))
