"""Disturbances of a cell, named in this package's `world.toml`; those of sensors are in a file of their own.

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
from .placing import fixture_placement, place_fixture
from .scene import Scene
from .simulation import TICK
from .system import RobotSystem

Changed: TypeAlias = Callable[[float], float]
_AXES = "xyz"
_LEAST_MASS = 1e-3
#: a part stands on a fixture if its middle is less than this above, m
_STANDS = 0.5


def part_mass(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the mass of parts, kg, with their inertia; their size stays."""
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
    """Change the centre of mass of parts along one of their axes, m; the cell is made with it."""

    def moved(part: Part) -> Part:
        centre = list(part.centre_of_mass or (0.0, 0.0, 0.0))
        centre[_AXES.index(axis)] = change(centre[_AXES.index(axis)])
        return replace(part, centre_of_mass=(centre[0], centre[1], centre[2]))

    _remake_parts(making, names, moved)


def part_size(making: dict[str, Any], change: Changed, *, names: str, random: Random) -> None:
    """Change the edge lengths of parts, m; the cell is made with them."""

    def resized(part: Part) -> Part:
        if isinstance(part, Box):
            x, y, z = (change(edge) for edge in part.size)
            return replace(part, size=(x, y, z))
        if isinstance(part, Cylinder):
            return replace(part, diameter=change(part.diameter), height=change(part.height))
        raise LookupError(f"part {part.name!r} is neither a box nor a cylinder: its size is that of its file")

    _remake_parts(making, names, resized)


def part_position(cell: Cell, change: Changed, *, names: str, random: Random, axis: str) -> None:
    """Change the position of parts along a world axis, m."""
    for body in _part_bodies(cell, names):
        _place(cell, body)[_AXES.index(axis)] = change(float(_place(cell, body)[_AXES.index(axis)]))
    _forward(cell)


def part_angle(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the rotation of parts about the vertical, rad."""
    for body in _part_bodies(cell, names):
        _turn(_place(cell, body)[3:7], change(0.0))
    _forward(cell)


def friction_of_pads(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the friction of parts against what grips them: the pads of fingers, the lip of a suction cup."""
    _change_pairs(cell, change, names, is_in_grip=True)


def friction_of_surfaces(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the friction of parts on fixtures, and on everything else that they may lie on."""
    _change_pairs(cell, change, names, is_in_grip=False)
    model = cell.simulation.model
    for part in _named([scene_part.name for scene_part in cell.simulation.scene.parts], names, "part"):
        geom = model.geom(part).id
        model.geom_friction[geom, 0] = max(change(float(model.geom_friction[geom, 0])), 1e-5)


def grip_force(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the force of grippers, relative to the command: a worn one is weaker."""
    for name, system in cell.robots.items():
        if fnmatchcase(name, names):
            system.gripper.set_strength(change(1.0))


def vacuum_leak(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the opening that a worn lip leaves in suction cups, m²."""
    found = [
        candidate
        for name, candidate in cell.robots.items()
        if fnmatchcase(name, names) and candidate.vacuum() is not None
    ]
    if not found:
        raise LookupError("no robot has a suction cup")
    for robot in found:
        robot.suction.leak = max(change(robot.suction.leak), 0.0)


def fixture_position(cell: Cell, change: Changed, *, names: str, random: Random, axis: str) -> None:
    """Change the position of fixtures along a world axis, m, with the parts that stand on them."""
    for name in _fixtures(cell, names):
        position, orientation = fixture_placement(cell.simulation, name)
        position[_AXES.index(axis)] = change(float(position[_AXES.index(axis)]))
        place_fixture(cell.simulation, name, (position, orientation), _carried(cell, name))


def fixture_angle(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Turn fixtures about the vertical through their centres, rad, with the parts that stand on them."""
    for name in _fixtures(cell, names):
        position, orientation = fixture_placement(cell.simulation, name)
        _turn(orientation, change(0.0))
        place_fixture(cell.simulation, name, (position, orientation), _carried(cell, name))


def base_position(cell: Cell, change: Changed, *, names: str, random: Random, axis: str) -> None:
    """Change the position of robots along a world axis, m, without the knowledge of their controllers."""
    for body in [system.robot.body for system in robots(cell, names)]:
        place = cell.simulation.model.body_pos[body]
        place[_AXES.index(axis)] = change(float(place[_AXES.index(axis)]))
    _settle(cell)


def tool_position(cell: Cell, change: Changed, *, names: str, random: Random, axis: str) -> None:
    """Change the position of tools along a flange axis, m, without the knowledge of the controllers."""
    for system in robots(cell, names):
        tool = system.robot.model.tool
        if tool is None:
            raise LookupError("the robot has no tool")
        place = cell.simulation.model.body_pos[cell.simulation.id_of("body", system.robot.prefix + tool.body)]
        place[_AXES.index(axis)] = change(float(place[_AXES.index(axis)]))
    _settle(cell)


def joint_calibration(cell: Cell, change: Changed, *, names: str, random: Random, joint: int) -> None:
    """Change the error of a joint's encoder, rad."""
    for system in robots(cell, names):
        error = system.robot.encoder_error.tolist()
        error[joint - 1] = change(error[joint - 1])
        system.robot.set_encoder_error(error)


def joint_friction(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the dry friction of all joints, Nm."""
    for system in robots(cell, names):
        losses = cell.simulation.model.dof_frictionloss[system.robot.dofs]
        losses[:] = [max(change(float(loss)), 0.0) for loss in losses]
    _settle(cell)


def servo_gain(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the stiffness of all joints' servos, Nm/rad; the planner uses the nominal one."""
    model = cell.simulation.model
    for system in robots(cell, names):
        gains = [change(float(gain)) for gain in model.actuator_gainprm[system.robot.servos, 0]]
        model.actuator_gainprm[system.robot.servos, 0] = gains
        model.actuator_biasprm[system.robot.servos, 1] = [-gain for gain in gains]


def actuation_delay(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Delay the setpoints of servos, s, in whole control ticks; also those of fingers.

    The protective stop compares joints with the setpoints that the servos have.
    """
    simulation, ticks = cell.simulation, round(change(0.0) / TICK)
    systems = robots(cell, names)
    late = deque([simulation.setpoints.copy()] * ticks)
    planned = {number: deque([robot.arm.setpoint.copy()] * ticks) for number, robot in enumerate(systems)}

    def delay() -> None:
        late.append(simulation.setpoints.copy())
        simulation.setpoints[:] = late.popleft()
        for number, system in enumerate(systems):
            planned[number].append(system.arm.setpoint.copy())
            compared[number] = planned[number].popleft()

    compared = {number: robot.arm.setpoint for number, robot in enumerate(systems)}
    simulation.before_tick.append(delay)
    for number, system in enumerate(systems):
        system.arm.compare_with(partial(compared.__getitem__, number))


def backlash(cell: Cell, change: Changed, *, names: str, random: Random, joint: int) -> None:
    """Change the play of a joint, rad: it follows its setpoint once that has gone through the play."""
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
    """Change the speed of belts relative to the command; their encoders show the true speed."""
    for name in _belts(cell, names):
        cell.belt(name).drive_factor = change(1.0)


def belt_jitter(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the standard deviation of the speed of belts, relative to it."""
    for name in _belts(cell, names):
        cell.belt(name).set_jitter(change(0.0))


def belt_encoder(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change what encoders of belts read, relative to the distance that the belts have run."""
    for name in _belts(cell, names):
        cell.belt(name).encoder_factor = change(1.0)


def _remake_parts(making: dict[str, Any], names: str, remade: Callable[[Part], Part]) -> None:
    scene: Scene = making.get("scene") or Scene()
    meant = _named([part.name for part in scene.parts], names, "part")
    parts = tuple(remade(part) if part.name in meant else part for part in scene.parts)
    making["scene"] = replace(scene, parts=parts)


def _change_pairs(cell: Cell, change: Changed, names: str, *, is_in_grip: bool) -> None:
    """Change the friction of pairs of shapes, which overrides that of the shapes themselves."""
    model, scene = cell.simulation.model, cell.simulation.scene
    parts = {int(model.geom(name).id) for name in _named([part.name for part in scene.parts], names, "part")}
    for pair in range(model.npair):
        others = {int(model.pair_geom1[pair]), int(model.pair_geom2[pair])} - parts
        # what takes hold of parts moves, what they lie on stands still
        moves = [bool(model.body_weldid[model.geom_bodyid[other]]) for other in others]
        if len(others) < 2 and all(is_moving == is_in_grip for is_moving in moves):
            model.pair_friction[pair, :2] = [
                max(change(float(coefficient)), 1e-5) for coefficient in model.pair_friction[pair, :2]
            ]


def _carried(cell: Cell, fixture: str) -> list[str]:
    """Return the names of the parts that stand on a fixture."""
    model, data = cell.simulation.model, cell.simulation.data
    body, geom = cell.simulation.id_of("body", fixture), model.geom(fixture).id
    half, axes = model.geom_size[geom], data.xmat[body].reshape(3, 3)
    found = []
    for part in cell.simulation.scene.parts:
        x, y, z = axes.T @ (data.body(part.name).xpos - data.xpos[body])
        if abs(x) <= half[0] and abs(y) <= half[1] and 0.0 < z - half[2] < _STANDS:
            found.append(part.name)
    return found


def _part_bodies(cell: Cell, names: str) -> list[int]:
    """Return the bodies of the parts with these names."""
    found = [part.name for part in cell.simulation.scene.parts]
    return [cell.simulation.id_of("body", name) for name in _named(found, names, "part")]


def _fixtures(cell: Cell, names: str) -> list[str]:
    return _named([fixture.name for fixture in cell.simulation.scene.fixtures], names, "fixture")


def _belts(cell: Cell, names: str) -> list[str]:
    return _named(
        [fixture.name for fixture in cell.simulation.scene.fixtures if fixture.belt is not None],
        names,
        "belt",
    )


def robots(cell: Cell, names: str) -> list[RobotSystem]:
    """Return the robots with these names; a single one has no name."""
    return [cell.robots[name] for name in _named([*cell.robots], names, "robot")]


def _named(found: Sequence[str], names: str, what: str) -> list[str]:
    meant = [name for name in found if fnmatchcase(name, names)]
    if not meant:
        raise LookupError(f"no {what} is named {names!r}; there are: {', '.join(found) or 'none'}")
    return meant


def _place(cell: Cell, body: int) -> Array:
    """Return the position and quaternion of a part as a writable view."""
    model = cell.simulation.model
    place: Array = cell.simulation.data.qpos[model.jnt_qposadr[model.body_jntadr[body]] :][:7]
    return place


def _turn(orientation: Array, angle: float) -> None:
    """Turn a quaternion (w, x, y, z) about the vertical of the world, rad, in place."""
    turned = np.zeros(4)
    mujoco.mju_mulQuat(turned, quaternion_from_euler(0.0, 0.0, math.degrees(angle)), orientation)
    orientation[:] = turned


def _forward(cell: Cell) -> None:
    mujoco.mj_forward(cell.simulation.model, cell.simulation.data)


def _settle(cell: Cell) -> None:
    """Recompute the model's constants after a change; the cell's own data would set the joints to zero."""
    mujoco.mj_setConst(cell.simulation.model, mujoco.MjData(cell.simulation.model))
    _forward(cell)
