"""The protective stop: what the arm's controller checks after every control tick."""

from __future__ import annotations

import operator
from collections.abc import Callable

import mujoco
import numpy as np

from .errors import ProtectiveStop
from .geometry import Array
from .robot import Robot
from .simulation import TICK, Simulation
from .stretch import LONGEST, Stretch

WARMING_TIME = 30.0
"""In this time a joint warms up by two thirds of what its torque makes of it in the end, s (our choice)."""

_WARMING_TICKS = 10
_SURELY = 1.0 - 1e-9
"""What is below a limit by this factor is below it however it is rounded."""


class Guard:
    """Finds the reasons to stop an arm: something pushes it, a joint lags, or a motor is too warm.

    Attributes:
        explained: what else than contacts acts on the tool, as a torque on each joint, shape (joints,), Nm.
        payload: that is set in the controller, kg.
        pressed_ticks: for how many ticks in a row something has pushed the arm too hard.
        planned: of each tick of a stretch, where the joints should be at its end, shape (LONGEST, joints),
            rad; the arm writes it.
    """

    def __init__(self, simulation: Simulation, robot: Robot) -> None:
        self._simulation, self._robot = simulation, robot
        limits, count = robot.model.limits, len(robot.model.joints)
        self.explained: list[Callable[[], Array]] = []
        self.payload = 0.0
        self.pressed_ticks = 0
        self._first_contact = ("", "", 0.0)
        self._limits = limits.external_torque
        self._torque_limit = np.array(limits.external_torque)
        self._lowest_torque_limit, self._following_limit = min(limits.external_torque), limits.following_error
        self._heat = np.zeros(count)
        self._continuous = np.array(limits.torque)
        # views of the physics' own memory
        self._constraints: Array = simulation.data.qfrc_constraint[robot.dofs]
        self._motors = simulation.data.qfrc_actuator[robot.dofs]
        self.planned, self._pushes = np.zeros((2, LONGEST, count))
        self._heats: list[tuple[int, Array]] = []
        self._looks_closer = False

    def state(self) -> tuple[int, bytes]:
        """Return the guard's memory between ticks, to compare two runs bit by bit."""
        return self.pressed_ticks, self._heat.tobytes()

    def overload(self, error: Callable[[], Array]) -> ProtectiveStop | None:
        """Warm the motors by the square of their torque; return the protective stop if one is too warm.

        Args:
            error: gives the following errors, shape (joints,), rad.
        """
        if self._simulation.ticks % _WARMING_TICKS:
            return None
        self._heat = self._warmer(self._heat, self._motors)
        if self._is_cool(self._heat):
            return None
        joint = int(np.argmax(self._heat))
        return ProtectiveStop(
            time=self._simulation.time,
            first="",
            second="",
            force=0.0,
            joint=joint + 1,
            torque=float(self._motors[joint]),
            following_error=float(error()[joint]),
            overload=float(self._continuous[joint]),
        )

    def collision(self, error: Array) -> ProtectiveStop | None:
        """Return the protective stop if something pushes the arm, or a joint lags behind; else None.

        Args:
            error: the following errors, shape (joints,), rad.
        """
        external = self._external()
        # this runs at every tick, and nearly always the lengths are below the lowest limits of their parts
        if (
            external.dot(external) <= self._lowest_torque_limit**2
            and error.dot(error) <= self._following_limit**2
        ):
            self.pressed_ticks = 0
            return None
        pressed = any(map(operator.gt, map(abs, external.tolist()), self._limits))
        self.pressed_ticks = self.pressed_ticks + 1 if pressed else 0
        if pressed and self.pressed_ticks == 1:
            self._first_contact = strongest_contact(self._simulation, self._robot)
        lagging = max(map(abs, error.tolist())) > self._following_limit
        if self.pressed_ticks < 2 and not lagging:
            return None
        joint = int(np.argmax(np.abs(external) / self._torque_limit if pressed else np.abs(error)))
        contacts = [strongest_contact(self._simulation, self._robot)]
        if pressed:
            contacts.append(self._first_contact)
        first, second, force = max(contacts, key=lambda contact: contact[2])
        return ProtectiveStop(
            time=self._simulation.time,
            first=first,
            second=second,
            force=force,
            joint=joint + 1,
            torque=float(external[joint]),
            following_error=float(error[joint]),
        )

    def begin_stretch(self) -> None:
        """Prepare for a stretch: find out whether the constraints' torques come from more than contacts."""
        model = self._simulation.model
        rubs = model.dof_frictionloss.any() or model.tendon_frictionloss.any()
        self._looks_closer = bool(self.explained or self.payload or rubs)

    def note(self, stretch: Stretch, number: int) -> None:
        """Record after a tick of a stretch (its number) what the stretch itself does not keep."""
        if self._looks_closer:
            stretch.reach(number)
            self._pushes[number] = self._external()

    def quiet(self, stretch: Stretch, known: int, ticks: int) -> int:
        """Return how many ticks of a stretch need no stop; see `lookahead.QuickCheck`."""
        dofs, now = self._robot.dofs, slice(known, ticks)
        external = self._pushes[now] if self._looks_closer else stretch.constraints[now, dofs]
        pushes = (external / self._torque_limit).ravel()
        errors = (self.planned[now] - stretch.places[now, self._robot.joints]).ravel()
        # mostly even the lengths of all together are below the limits of their parts; not so if one is NaN
        if not (pushes.dot(pushes) < 1.0 and errors.dot(errors) < self._following_limit**2):
            fine = (np.abs(pushes) < _SURELY) & (np.abs(errors) < _SURELY * self._following_limit)
            ticks = min([ticks, *(known + np.flatnonzero(~fine) // len(self._heat)).tolist()])
        # another arm may have been quiet for less long
        self._heats = [(number, heat) for number, heat in self._heats if number < known]
        heat = self._heats[-1][1] if self._heats else self._heat
        for number in range(known, ticks):
            if (self._simulation.ticks + 1 + number) % _WARMING_TICKS:
                continue
            heat = self._warmer(heat, stretch.motors[number, dofs])
            if not self._is_cool(heat):
                return number
            self._heats.append((number, heat))
        return ticks

    def passed(self, stretch: Stretch, ticks: int) -> None:
        """Warm the motors for the ticks that have passed; see `lookahead.QuickCheck`."""
        self._heat = next((heat for number, heat in reversed(self._heats) if number < ticks), self._heat)

    def _warmer(self, heat: Array, torques: Array) -> Array:
        """Return the motors' warmth after these torques have lasted for `_WARMING_TICKS`."""
        share = _WARMING_TICKS * TICK / WARMING_TIME
        warmer: Array = heat + share * ((torques / self._continuous) ** 2 - heat)
        return warmer

    @staticmethod
    def _is_cool(heat: Array) -> bool:
        return bool(heat.dot(heat) <= 1.0 or heat.max() <= 1.0)

    def _external(self) -> Array:
        """Return each joint's torque beyond motors, friction, the arm and its declared payload, Nm."""
        torque = self._constraints
        for explain in self.explained:
            torque = torque + explain()
        if self._simulation.data.nf:
            torque = torque - self._friction()
        if self.payload:
            torque = torque - self._payload_torque()
        return torque

    def _friction(self) -> Array:
        """Return each joint's torque from its dry friction, which MuJoCo counts among the constraints, Nm."""
        data = self._simulation.data
        torque = np.zeros(len(self._heat))
        for row in range(data.ne, data.ne + data.nf):  # rows of friction follow those of equalities
            joint = int(data.efc_id[row]) - self._robot.dofs.start
            of_joint = data.efc_type[row] == mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF
            if of_joint and 0 <= joint < len(torque):
                torque[joint] = data.efc_force[row]
        return torque

    def _payload_torque(self) -> Array:
        """Return each joint's torque from the payload's weight and inertia, Nm."""
        cell_model, data = self._simulation.model, self._simulation.data
        mujoco.mj_rnePostConstraint(cell_model, data)
        # acceleration minus gravity of the payload's centre of mass, as an accelerometer there would read it
        felt = np.zeros(6)
        mujoco.mj_objectAcceleration(cell_model, data, mujoco.mjtObj.mjOBJ_BODY, self._robot.payload, felt, 0)
        moves = np.zeros((3, cell_model.nv))
        mujoco.mj_jacBodyCom(cell_model, data, moves, None, self._robot.payload)
        torque: Array = np.dot(-self.payload * felt[3:], moves[:, self._robot.dofs])
        return torque


def strongest_contact(simulation: Simulation, robot: Robot) -> tuple[str, str, float]:
    """Return the robot's strongest contact: its part, what it touches, and the normal force (N).

    A box between the fingers counts as the robot's part; ("", "", 0.0) without a contact.
    """
    cell_model, data = simulation.model, simulation.data
    body = int(cell_model.body_rootid[robot.body])
    found: tuple[str, str, float] = ("", "", 0.0)
    wrench = np.zeros(6)
    for index in range(data.ncon):
        geoms = [int(geom) for geom in data.contact[index].geom]
        roots = [int(cell_model.body_rootid[cell_model.geom_bodyid[geom]]) for geom in geoms]
        if body not in roots:
            continue
        if roots[1] == body and roots[0] != body:
            geoms.reverse()
        mujoco.mj_contactForce(cell_model, data, index, wrench)
        if abs(wrench[0]) > found[2]:
            found = (_name(cell_model, geoms[0]), _name(cell_model, geoms[1]), abs(float(wrench[0])))
    return found


def _name(model: mujoco.MjModel, geom: int) -> str:
    """Return the name of a shape, or of its body: files often name only bodies."""
    return str(model.geom(geom).name or model.body(int(model.geom_bodyid[geom])).name)
