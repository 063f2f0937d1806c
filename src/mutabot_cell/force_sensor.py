"""The force and torque sensor between the arm's flange and its tool."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from mutabot_cell.models.noise import SeededNoise

from .geometry import Array
from .robot import Robot
from .simulation import Simulation

FORCE_RANGE, TORQUE_RANGE = 300.0, 30.0
"""Beyond which it reads its end, N and Nm (data sheet of Robotiq's FT 300-S, whose rate is 100 a second)."""


@dataclass(frozen=True, slots=True)
class Wrench:
    """A force in N and a torque in Nm, along the axes and about the origin of the sensor's frame."""

    fx: float
    fy: float
    fz: float
    tx: float
    ty: float
    tz: float

    @property
    def force(self) -> float:
        """The magnitude of the force, N."""
        return float(np.linalg.norm((self.fx, self.fy, self.fz)))


class ForceSensor:
    """Reads what the tool, what it holds and what it touches exert on the flange.

    Its frame is the flange's: z points away from the arm. A tool that hangs straight down
    reads its weight as +z, one that presses on something below less. It feels all that such a sensor feels:
    the tool's weight in every orientation, and its inertia while the arm moves.

    It measures 100 times a second, once per control tick.
    """

    def __init__(self, simulation: Simulation, robot: Robot, noise: SeededNoise) -> None:
        self._simulation = simulation
        self._robot = robot
        self._noise = noise
        self._read: tuple[int, Array] = (-1, np.zeros(6))
        self._zero = np.zeros(6)

    def wrench(self) -> Wrench:
        """Return the reading of this tick, minus the reading when `zero` was called."""
        return Wrench(*(self._measured() - self._zero).tolist())

    def zero(self) -> None:
        """Read 0 for the present load from now on, as long as the tool keeps its orientation."""
        self._zero = self._measured().copy()

    def _measured(self) -> Array:
        ticks, reading = self._read
        if ticks != self._simulation.ticks:
            exact = true_wrench(self._simulation, self._robot)
            noisy = [self._noise.add("force", part) for part in exact[:3].tolist()]
            noisy += [self._noise.add("torque", part) for part in exact[3:].tolist()]
            limits = np.repeat((FORCE_RANGE, TORQUE_RANGE), 3)
            reading = np.clip(noisy, -limits, limits)
            self._read = self._simulation.ticks, reading
        return reading


def true_wrench(simulation: Simulation, robot: Robot) -> Array:
    """Return the force and torque of the tool on the flange, shape (6,), in the flange's frame, N and Nm.

    It is what inverse dynamics finds in the connection, with contacts, vacuum and inertia; 0 without a tool.
    """
    model, data, tool = simulation.model, simulation.data, robot.model.tool
    if tool is None:
        return np.zeros(6)
    # the integrator damps the servos implicitly, so joints accelerate less than `qacc` says; what servos
    # measured is the speed before the last step
    forecast = data.qacc[robot.dofs].copy()
    before = data.actuator_velocity[robot.servos] / model.actuator_gear[robot.servos, 0]
    data.qacc[robot.dofs] = (data.qvel[robot.dofs] - before) / model.opt.timestep
    mujoco.mj_rnePostConstraint(model, data)
    data.qacc[robot.dofs] = forecast
    body = simulation.id_of("body", robot.prefix + tool.body)
    flange = simulation.id_of("site", robot.prefix + robot.model.flange)
    torque, force = data.cfrc_int[body, :3], data.cfrc_int[body, 3:]
    lever = data.subtree_com[model.body_rootid[body]] - data.site_xpos[flange]
    axes = data.site_xmat[flange].reshape(3, 3)
    return np.concatenate((-force @ axes, -(torque + np.cross(lever, force)) @ axes))
