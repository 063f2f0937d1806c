"""Disturbances of a cell's things: what `world.toml` of this package names; those of sensors stand apart.

Each is a function of the cell, or of what it is made with, and of the change, which says what becomes of a
number in SI units; and, by name, of `names` (which of the cell's things are meant), `random`, and options.
Each raises LookupError if the cell has nothing of the name. They change the cell at once, also in a run.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from functools import partial
from random import Random
from typing import Any, TypeAlias

import mujoco
import numpy as np

from .cell import Cell
from .geometry import Array, quaternion_from_euler
from .parts import Box, Cylinder, Part
from .scene import Scene
from .simulation import TICK
from .system import RobotSystem

Changed: TypeAlias = Callable[[float], float]
_AXES = "xyz"
_LEAST_MASS = 1e-3
#: a part stands on a fixture if its middle is less than this above, m
_STANDS = 0.5


def part_mass(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Mass of parts, kg, with their inertia: they are as large as before."""
    model = cell.simulation.model
    for body in _part_bodies(cell, names):
        before = float(model.body_mass[body])
        factor = max(change(before), _LEAST_MASS) / before
        model.body_mass[body] *= factor
        model.body_inertia[body] *= factor
    _settle(cell)


def part_centre_of_mass(
    making: dict[str, Any], change: Changed, *, names: str, random: Random, axis: str
) -> None:
    """Centre of mass of parts along an axis of theirs, m; the cell is made with it."""

    def moved(part: Part) -> Part:
        centre = list(part.centre_of_mass or (0.0, 0.0, 0.0))
        centre[_AXES.index(axis)] = change(centre[_AXES.index(axis)])
        return replace(part, centre_of_mass=(centre[0], centre[1], centre[2]))

    _remake_parts(making, names, moved)


def part_size(making: dict[str, Any], change: Changed, *, names: str, random: Random) -> None:
    """Edges of parts, m; the cell is made with them."""

    def resized(part: Part) -> Part:
        if isinstance(part, Box):
            x, y, z = (change(edge) for edge in part.size)
            return replace(part, size=(x, y, z))
        if isinstance(part, Cylinder):
            return replace(part, diameter=change(part.diameter), height=change(part.height))
        raise LookupError(f"part {part.name!r} is neither a box nor a cylinder: its size is that of its file")

    _remake_parts(making, names, resized)


def part_position(cell: Cell, change: Changed, *, names: str, random: Random, axis: str) -> None:
    """Where parts lie along an axis of the world, m."""
    for body in _part_bodies(cell, names):
        _place(cell, body)[_AXES.index(axis)] = change(float(_place(cell, body)[_AXES.index(axis)]))
    _forward(cell)


def part_angle(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """How parts are turned about the vertical, rad."""
    turn = quaternion_from_euler(0.0, 0.0, math.degrees(change(0.0)))
    for body in _part_bodies(cell, names):
        turned, place = np.zeros(4), _place(cell, body)
        mujoco.mju_mulQuat(turned, turn, place[3:7])
        place[3:7] = turned
    _forward(cell)


def friction_of_pads(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Friction of parts against what takes hold of them: the pads of fingers, the lip of a suction cup."""
    _change_pairs(cell, change, names, is_in_grip=True)


def friction_of_surfaces(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Friction of parts on fixtures, and on all else that they may lie on."""
    _change_pairs(cell, change, names, is_in_grip=False)
    model = cell.simulation.model
    for part in _named([one.name for one in cell.simulation.scene.parts], names, "part"):
        geom = model.geom(part).id
        model.geom_friction[geom, 0] = max(change(float(model.geom_friction[geom, 0])), 1e-5)


def grip_force(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Force of grippers, as a part of what they are commanded: a worn one is weaker."""
    for name, system in cell.robots.items():
        if fnmatchcase(name, names):
            system.gripper.set_strength(change(1.0))


def vacuum_leak(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Opening of suction cups that a worn lip leaves, m²."""
    found = [
        one for name, one in cell.robots.items() if fnmatchcase(name, names) and one.vacuum() is not None
    ]
    if not found:
        raise LookupError("no robot has a suction cup")
    for one in found:
        one.suction.leak = max(change(one.suction.leak), 0.0)


def fixture_position(cell: Cell, change: Changed, *, names: str, random: Random, axis: str) -> None:
    """Where fixtures stand along an axis of the world, m, with the parts that stand on them."""
    for name in _fixtures(cell, names):
        body = cell.simulation.id_of("body", name)
        before = float(cell.simulation.model.body_pos[body][_AXES.index(axis)])
        carried = _carried(cell, name)
        cell.simulation.model.body_pos[body][_AXES.index(axis)] = change(before)
        for part in carried:
            _place(cell, part)[_AXES.index(axis)] += change(before) - before
    _forward(cell)


def fixture_angle(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """How fixtures are turned about the vertical, rad; parts on them keep their places."""
    turn, model = quaternion_from_euler(0.0, 0.0, math.degrees(change(0.0))), cell.simulation.model
    for name in _fixtures(cell, names):
        body, turned = cell.simulation.id_of("body", name), np.zeros(4)
        mujoco.mju_mulQuat(turned, turn, model.body_quat[body])
        model.body_quat[body] = turned
    _forward(cell)


def base_position(cell: Cell, change: Changed, *, names: str, random: Random, axis: str) -> None:
    """Where robots stand along an axis of the world, m: their controllers take them to be elsewhere."""
    for body in [system.robot.body for system in robots(cell, names)]:
        place = cell.simulation.model.body_pos[body]
        place[_AXES.index(axis)] = change(float(place[_AXES.index(axis)]))
    _settle(cell)


def tool_position(cell: Cell, change: Changed, *, names: str, random: Random, axis: str) -> None:
    """Where tools sit along an axis of the flange, m: the controllers take them to be elsewhere."""
    for system in robots(cell, names):
        tool = system.robot.model.tool
        if tool is None:
            raise LookupError("the robot has no tool")
        place = cell.simulation.model.body_pos[cell.simulation.id_of("body", system.robot.prefix + tool.body)]
        place[_AXES.index(axis)] = change(float(place[_AXES.index(axis)]))
    _settle(cell)


def joint_calibration(cell: Cell, change: Changed, *, names: str, random: Random, joint: int) -> None:
    """What a joint's encoder reads too much, rad."""
    for system in robots(cell, names):
        error = system.robot.encoder_error.tolist()
        error[joint - 1] = change(error[joint - 1])
        system.robot.set_encoder_error(error)


def joint_friction(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Dry friction of all joints, Nm."""
    for system in robots(cell, names):
        losses = cell.simulation.model.dof_frictionloss[system.robot.dofs]
        losses[:] = [max(change(float(one)), 0.0) for one in losses]
    _settle(cell)


def servo_gain(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Stiffness of all joints' servos, Nm/rad; the planner reckons with the nominal one."""
    model = cell.simulation.model
    for system in robots(cell, names):
        gains = [change(float(one)) for one in model.actuator_gainprm[system.robot.servos, 0]]
        model.actuator_gainprm[system.robot.servos, 0] = gains
        model.actuator_biasprm[system.robot.servos, 1] = [-one for one in gains]


def actuation_delay(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """By how much later servos get their setpoints, s, in whole control ticks; also those of fingers.

    The protective stop compares joints with the setpoints that the servos have.
    """
    simulation, ticks = cell.simulation, round(change(0.0) / TICK)
    systems = robots(cell, names)
    late = deque([simulation.setpoints.copy()] * ticks)
    planned = {number: deque([one.arm.setpoint.copy()] * ticks) for number, one in enumerate(systems)}

    def delay() -> None:
        late.append(simulation.setpoints.copy())
        simulation.setpoints[:] = late.popleft()
        for number, system in enumerate(systems):
            planned[number].append(system.arm.setpoint.copy())
            compared[number] = planned[number].popleft()

    compared = {number: one.arm.setpoint for number, one in enumerate(systems)}
    simulation.before_tick.append(delay)
    for number, system in enumerate(systems):
        system.arm.compare_with(partial(compared.__getitem__, number))


def backlash(cell: Cell, change: Changed, *, names: str, random: Random, joint: int) -> None:
    """Play of a joint, rad: it follows its setpoint when that has gone through the play."""
    simulation, half = cell.simulation, change(0.0) / 2
    for system in robots(cell, names):
        number = system.robot.servos.start + joint - 1
        _add_play(simulation.setpoints, number, half, simulation.before_tick)


def _add_play(setpoints: Array, servo: int, half: float, hooks: list[Callable[[], None]]) -> None:
    there = float(setpoints[-1, servo])

    def play() -> None:
        nonlocal there
        for row in setpoints:
            there = min(max(there, float(row[servo]) - half), float(row[servo]) + half)
            row[servo] = there

    hooks.append(play)


def belt_speed(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Speed of belts as a part of what they are commanded; their encoders tell the truth."""
    for name in _belts(cell, names):
        cell.belt(name).drive_factor = change(1.0)


def belt_jitter(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Standard deviation of the speed of belts, as a part of it."""
    for name in _belts(cell, names):
        cell.belt(name).set_jitter(change(0.0))


def belt_encoder(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """What encoders of belts read, as a part of how far the belts have gone."""
    for name in _belts(cell, names):
        cell.belt(name).encoder_factor = change(1.0)


def _remake_parts(making: dict[str, Any], names: str, remade: Callable[[Part], Part]) -> None:
    scene: Scene = making.get("scene") or Scene()
    meant = _named([part.name for part in scene.parts], names, "part")
    parts = tuple(remade(part) if part.name in meant else part for part in scene.parts)
    making["scene"] = replace(scene, parts=parts)


def _change_pairs(cell: Cell, change: Changed, names: str, *, is_in_grip: bool) -> None:
    """Change what pairs of shapes say, without which friction of the shapes themselves has no effect."""
    model, scene = cell.simulation.model, cell.simulation.scene
    parts = {int(model.geom(name).id) for name in _named([one.name for one in scene.parts], names, "part")}
    for pair in range(model.npair):
        others = {int(model.pair_geom1[pair]), int(model.pair_geom2[pair])} - parts
        # what takes hold of parts moves, what they lie on stands still
        moves = [bool(model.body_weldid[model.geom_bodyid[other]]) for other in others]
        if len(others) < 2 and all(one == is_in_grip for one in moves):
            model.pair_friction[pair, :2] = [
                max(change(float(one)), 1e-5) for one in model.pair_friction[pair, :2]
            ]


def _carried(cell: Cell, fixture: str) -> list[int]:
    """The bodies of the parts that stand on a fixture."""
    model, data = cell.simulation.model, cell.simulation.data
    body, geom = cell.simulation.id_of("body", fixture), model.geom(fixture).id
    half, axes = model.geom_size[geom], data.xmat[body].reshape(3, 3)
    found = []
    for part in _part_bodies(cell, "*") if cell.simulation.scene.parts else []:
        x, y, z = axes.T @ (data.xpos[part] - data.xpos[body])
        if abs(x) <= half[0] and abs(y) <= half[1] and 0.0 < z - half[2] < _STANDS:
            found.append(part)
    return found


def _part_bodies(cell: Cell, names: str) -> list[int]:
    """The bodies of the parts that are meant."""
    found = [part.name for part in cell.simulation.scene.parts]
    return [cell.simulation.id_of("body", name) for name in _named(found, names, "part")]


def _fixtures(cell: Cell, names: str) -> list[str]:
    return _named([one.name for one in cell.simulation.scene.fixtures], names, "fixture")


def _belts(cell: Cell, names: str) -> list[str]:
    return _named([one.name for one in cell.simulation.scene.fixtures if one.belt is not None], names, "belt")


def robots(cell: Cell, names: str) -> list[RobotSystem]:
    """The robots that are meant; the only one has no name."""
    return [cell.robots[name] for name in _named([*cell.robots], names, "robot")]


def _named(found: Sequence[str], names: str, what: str) -> list[str]:
    meant = [name for name in found if fnmatchcase(name, names)]
    if not meant:
        raise LookupError(f"no {what} is named {names!r}; there are: {', '.join(found) or 'none'}")
    return meant


def _place(cell: Cell, body: int) -> Array:
    """Position and quaternion of a part, which may be written."""
    model = cell.simulation.model
    place: Array = cell.simulation.data.qpos[model.jnt_qposadr[model.body_jntadr[body]] :][:7]
    return place


def _forward(cell: Cell) -> None:
    mujoco.mj_forward(cell.simulation.model, cell.simulation.data)


def _settle(cell: Cell) -> None:
    """Let constants of the model follow a change; with the cell's own data, the joints would go to zero."""
    mujoco.mj_setConst(cell.simulation.model, mujoco.MjData(cell.simulation.model))
    _forward(cell)
