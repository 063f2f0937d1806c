"""The physical facts of the cell, measured and printed beside what physics or the maker says.

    python benchmarks/cell_physics.py [FACT ...]

Facts: path, encoders, repeatability, coulomb, payload, holding, creep, rebound, limits, inertia, friction,
sensors, sight, suction, rolling, weighing, energy.
All of them without an argument.
"""

from __future__ import annotations

import math
import statistics
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import mujoco
import numpy as np

from mutabot_cell import Box, Cell, CellError, Cylinder, Scene, gen3, suction_cup
from mutabot_cell.models import kinova
from mutabot_cell.models.assembly import build_arm
from mutabot_cell.models.parts import ROLLING
from mutabot_cell.models.vacuum import Ejector

GRAVITY = 9.81
DOWN = (0.0, 26.0, 180.0, -78.0, 0.0, -76.0, 90.0)
"""Joint angles with the gripper looking down over the conveyor, degrees."""
BEHIND = (-145.0, 26.0, 180.0, -78.0, 0.0, -76.0, 90.0)


def grip(cell: Cell, force: float = 60.0) -> None:
    """Close the fingers on the box on the conveyor, from above and in the middle."""
    box = cell.truth.box_position()
    cell.arm.move_joints(DOWN)
    pose = cell.arm.commanded_pose()
    cell.arm.move_by(x=box.x - pose.x, y=box.y - pose.y)
    cell.arm.move_by(z=box.z + 0.03 - 0.9 - pose.z)
    cell.gripper.set_force(force)
    cell.gripper.command(1, wait=True)


def _grip_aside(cell: Cell, force: float) -> None:
    """As the published program does: from the side, 9 mm from the edge."""
    cell.arm.move_by(y=0.2)
    cell.arm.move_by(theta_x=80)
    cell.arm.move_by(z=-0.29)
    cell.gripper.set_force(force)
    cell.gripper.command(1, wait=True)


def slip(cell: Cell) -> tuple[float, float, float]:
    """Where the box is in the tool's frame, m."""
    data = cell.simulation.data
    site = cell.simulation.id_of("site", "tool")
    away = data.xpos[cell.simulation.id_of("body", "box")] - data.site_xpos[site]
    x, y, z = (data.site_xmat[site].reshape(3, 3).T @ away).tolist()
    return x, y, z


def path() -> Iterator[str]:
    """How far the tool leaves its line, and where it ends."""
    cell = Cell(1, noise=False)
    for move in ({"y": 0.2}, {"z": -0.25}, {"x": -0.2, "y": 0.2}):
        start = np.array(cell.truth.tool_position())
        shift = np.array([move.get(axis, 0.0) for axis in "xyz"])
        ideal = np.array(cell.arm.commanded_pose().position)
        places: list[np.ndarray] = []
        note = _noting(cell, places)
        cell.arm.move_by(**move)
        cell.simulation.after_tick.remove(note)
        along = shift / np.linalg.norm(shift)
        away = np.array(places) - start
        sideways = np.linalg.norm(away - np.outer(away @ along, along), axis=1).max()
        end = np.linalg.norm(np.array(cell.truth.tool_position()) - ideal - shift)
        yield f"{move}: off the line by {1000 * sideways:.2f} mm, off the end by {1000 * end:.2f} mm"


def _noting(cell: Cell, places: list[np.ndarray]) -> Callable[[], None]:
    def note() -> None:
        places.append(np.array(cell.truth.tool_position()))

    cell.simulation.after_tick.append(note)
    return note


def encoders() -> Iterator[str]:
    """Joint 2 calibrated wrongly by one degree: what the tool does, and what the robot says of itself."""
    cell = Cell(1, noise=False)
    before, said = cell.truth.tool_position(), cell.sensors.tool_pose().position
    cell.simulation.robot.set_encoder_error((0.0, math.radians(1), 0.0, 0.0, 0.0, 0.0, 0.0))
    cell.wait(1)
    moved = math.dist(_xyz(before), _xyz(cell.truth.tool_position()))
    seen = math.dist(_xyz(said), _xyz(cell.sensors.tool_pose().position))
    yield f"1 deg at joint 2: tool moved by {1000 * moved:.2f} mm, tool_pose() by {1000 * seen:.2f} mm"


def _xyz(place: object) -> tuple[float, float, float]:
    return (place.x, place.y, place.z)  # type: ignore[attr-defined]


def repeatability() -> Iterator[str]:
    """Ten returns home: scatter of the tool, and of what the encoders say of it."""
    for noise in (False, True):
        cell = Cell(1, noise=noise)
        true, read = [], []
        for _ in range(10):
            cell.arm.move_by(y=0.2)
            cell.arm.home()
            cell.wait(0.5)
            true.append(np.array(cell.truth.tool_position()))
            read.append(np.array(cell.sensors.tool_pose().position))
        spread = [np.std(np.array(places), axis=0).max() * 1e6 for places in (true, read)]
        yield f"noise {noise}: tool {spread[0]:.2f} um, encoders {spread[1]:.1f} um"


def coulomb() -> Iterator[str]:
    """Lowest friction at which 60 N lift a box, beside the law: m (g + a) = 2 mu F."""
    for mass, ladder in ((0.1, (0.005, 0.007, 0.008, 0.009, 0.010, 0.012, 0.02)),
                         (0.5, (0.03, 0.035, 0.04, 0.042, 0.045, 0.05, 0.06))):  # fmt: skip
        for friction in ladder:
            cell = Cell(1, scene=Scene(parts=(Box(mass=mass, friction=friction),)))
            grip(cell)
            cell.arm.set_payload(mass)
            try:
                cell.arm.move_by(z=0.1, speed=0.05)
                cell.wait(1.0)
            except CellError:  # a box that slips out of the fingers' tips can push them aside
                continue
            if cell.truth.box_position().z > 1.08:
                break
        law = mass * GRAVITY / (2 * 60.0)
        yield f"{mass} kg: held from mu = {friction} on; at rest the law says {law:.4f}"


def payload() -> Iterator[str]:
    """Parts of 0.1 to 4 kg, lifted, turned and carried over with 235 N."""
    for mass in (0.1, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0):
        cell = Cell(1, scene=Scene(parts=(Box(mass=mass),)))
        try:
            grip(cell, 235.0)
            cell.arm.set_payload(mass)
            before = slip(cell)
            cell.arm.move_by(z=0.15)
            cell.arm.move_by(theta_z=60)
            cell.arm.move_by(theta_z=-60)
            cell.arm.move_joints(BEHIND)
            moved = 1000 * math.dist(before, slip(cell))
            torque = np.abs(cell.simulation.data.qfrc_actuator[:7]).max()
            yield f"{mass} kg: carried, moved in the grip by {moved:.2f} mm, at rest {torque:.0f} Nm"
        except CellError as error:
            yield f"{mass} kg: {error}"


def holding() -> Iterator[str]:
    """Share of ticks at which a box held at rest is reported as not held."""
    for mass in (0.1, 0.5, 1.0, 1.5, 2.0, 4.0):
        shares = []
        for force in (60.0, 235.0):
            cell = Cell(1, scene=Scene(parts=(Box(mass=mass),)))
            try:
                _grip_aside(cell, force)
                cell.arm.set_payload(mass)
                cell.arm.move_by(z=0.15)
                cell.arm.move_joints(BEHIND)
            except CellError:
                shares.append("stopped")
                continue
            cell.wait(0.3)
            flags = []
            for _ in range(500):
                cell.simulation.tick()
                flags.append(cell.gripper.holding())
            shares.append(f"{100 * flags.count(False) / len(flags):.1f} %")
        yield f"{mass} kg: not held at {shares[0]} of the ticks with 60 N, {shares[1]} with 235 N"


def creep() -> Iterator[str]:
    """How far a box moves in the fingers per move, 60 N."""
    for mass in (0.1, 0.5):
        cell = Cell(1, scene=Scene(parts=(Box(mass=mass),)))
        grip(cell)
        cell.arm.set_payload(mass)
        told = []
        for name, move in (("up 0.2 m", {"z": 0.2}), ("across 0.4 m", {"y": -0.4}),
                           ("turned 60 deg", {"theta_z": 60.0}), ("carried over", {})):  # fmt: skip
            before = slip(cell)
            if move:
                cell.arm.move_by(**move)
            else:
                cell.arm.move_joints(BEHIND)
            told.append(f"{name} {1000 * math.dist(before, slip(cell)):.2f}")
        before = slip(cell)
        cell.wait(10)
        told.append(f"10 s at rest {1000 * math.dist(before, slip(cell)):.3f}")
        yield f"{mass} kg, mm: " + ", ".join(told)


def rebound() -> Iterator[str]:
    """A box dropped flat and askew on the conveyor: depth, restitution, rest."""
    for height, yaw in ((0.1, 0.0), (0.3, 0.0), (0.3, 20.0)):
        cell = Cell(1, scene=Scene(parts=(Box(position=(0.55, 0.6, 1.0 + height), jitter=0.0),)))
        if yaw:
            half = math.radians(yaw) / 2
            cell.simulation.data.qpos[-4:] = (math.cos(half), math.sin(half), 0, 0)
            mujoco.mj_forward(cell.simulation.model, cell.simulation.data)
        heights = []
        energy = []
        for _ in range(300):
            cell.simulation.tick()
            place = cell.simulation.data.xpos[cell.simulation.id_of("body", "box")]
            heights.append(_lowest(cell))
            energy.append(float(place[2]))
        first = next(i for i, low in enumerate(heights) if low < 0.001)
        top = max(heights[first + 1 :])
        rest = heights[-1]
        yield (
            f"from {height} m{f', askew by {yaw} deg' if yaw else ''}: {-1000 * min(heights):.1f} mm deep, "
            f"jumps {1000 * top:.1f} mm (restitution {math.sqrt(max(0.0, top) / height):.2f}), "
            f"rests {-1000 * rest:.2f} mm in the surface"
        )


def _lowest(cell: Cell) -> float:
    """Height of the box's lowest corner above the conveyor, m."""
    data, body = cell.simulation.data, cell.simulation.id_of("body", "box")
    down = float(np.abs(data.xmat[body].reshape(3, 3)[2]).sum()) * 0.025
    return float(data.xpos[body][2]) - down - 1.0


def limits() -> Iterator[str]:
    """Joint limits beside the maker's."""
    found = [round(math.degrees(joint.limit), 1) for joint in kinova.JOINTS if not math.isinf(joint.limit)]
    yield f"joints 2, 4, 6: {found} deg; the maker says [128.9, 147.8, 120.3]"


def inertia() -> Iterator[str]:
    """Centres of mass and inertias beside the maker's description."""
    cell = Cell(1)
    model = cell.simulation.model
    for number, (mass, place, largest) in enumerate(PUBLISHED, 1):
        body = model.body(f"link {number}").id
        off = 1000 * math.dist(model.body_ipos[body], place)
        ratio = model.body_inertia[body].max() / largest
        weight = f"{model.body_mass[body]:.4f} of {mass} kg"
        yield f"link {number}: mass {weight}, centre off by {off:.1f} mm, inertia x {ratio:.2f}"


PUBLISHED = (
    (1.3773, (-2.3e-05, -0.010364, -0.07336), 0.00488868),
    (1.1636, (-4.4e-05, -0.09958, -0.013278), 0.0113017),
    (1.1636, (-4.4e-05, -0.006641, -0.117892), 0.0111633),
    (0.9302, (-1.8e-05, -0.075478, -0.015006), 0.00834839),
    (0.6781, (1e-06, -0.009432, -0.063883), 0.00165901),
    (0.6781, (1e-06, -0.045483, -0.00965), 0.00170087),
    (0.5, (0.000281, 0.011402, -0.029798), 0.000657336),
)


def friction() -> Iterator[str]:
    """The tangent of the steepest slope on which a box stays: gravity is tilted instead of the cell."""
    for name, place in (("conveyor", (0.55, 0.6, 1.0)), ("table", (-0.6, 0.3, 0.76))):
        for degrees in range(5, 60):
            cell = Cell(1, scene=Scene(parts=(Box(position=place, jitter=0.0),)))
            slope = math.radians(degrees)
            cell.simulation.model.opt.gravity[:] = (0, -GRAVITY * math.sin(slope), -GRAVITY * math.cos(slope))
            cell.wait(1.0)
            if cell.truth.box_tilt() > 5 or place[1] - cell.truth.box_position().y > 0.01:
                break
        what = "tips over" if cell.truth.box_tilt() > 5 else "slides"
        yield f"{name}: {what} from {degrees} deg on, mu = {math.tan(math.radians(degrees - 0.5)):.2f}"


def sensors() -> Iterator[str]:
    """Readings within one instant, and of something that moves."""
    cell = Cell(1)
    readings = [cell.sensors.box_position().x for _ in range(1000)]
    away = abs(statistics.mean(readings) - cell.truth.box_position().x)
    yield f"1000 readings of the camera at once: {len(set(readings))} values, mean off by {1e6 * away:.0f} um"
    cell = Cell(
        1, noise=False, scene=Scene(parts=(Box(position=(0.55, 0.2, 1.0), jitter=0.0, friction=0.0),))
    )
    cell.simulation.data.qvel[9:12] = (0, -0.5, 0)
    lags = []
    for _ in range(100):
        cell.simulation.tick()
        lags.append((cell.sensors.box_position().y - cell.truth.box_position().y) / 0.5)
    yield f"a box that slides at 0.5 m/s is seen {1000 * min(lags):.0f} to {1000 * max(lags):.0f} ms late"


def sight() -> Iterator[str]:
    """What the camera says of a box behind a wall."""
    from mutabot_cell import Fixture  # noqa: PLC0415
    from mutabot_cell.scene import CONVEYOR, TARGET_TABLE  # noqa: PLC0415

    cell = Cell(1, scene=Scene(fixtures=(CONVEYOR, TARGET_TABLE), parts=(Box(),)))
    yield f"in the open: {cell.sensors.box_position()}"
    walls = tuple(
        Fixture(f"wall {i}", size, centre)
        for i, (size, centre) in enumerate(
            (
                ((0.3, 0.01, 0.3), (0.55, 0.3, 1.15)), ((0.3, 0.01, 0.3), (0.55, 0.1, 1.15)),
                ((0.01, 0.3, 0.3), (0.70, 0.2, 1.15)), ((0.01, 0.3, 0.3), (0.40, 0.2, 1.15)),
                ((0.4, 0.4, 0.01), (0.55, 0.2, 1.31)),
            )
        )
    )  # fmt: skip
    cell = Cell(1, scene=Scene(fixtures=(CONVEYOR, TARGET_TABLE, *walls), parts=(Box(),)))
    try:
        yield f"under a closed hood: {cell.sensors.box_position()}"
    except CellError as error:
        yield f"under a closed hood: {error}"


def suction() -> Iterator[str]:
    """What a suction cup holds, beside vacuum times area: the part is pulled down until it comes off."""
    for diameter, limit in ((0.02, 60e3), (0.03, 60e3), (0.03, 30e3), (0.04, 40e3)):
        cell = _sucked(diameter, limit)
        force, weight = limit * math.pi * diameter**2 / 4, 0.5 * GRAVITY
        down = cell.simulation.model.joint("box").dofadr[0] + 2
        pull = 0.0
        while cell.suction.holding() or cell.suction.vacuum() > 0.9 * limit:
            pull += 0.1
            cell.simulation.data.qfrc_applied[down] = weight - pull
            cell.simulation.tick()
        cup = f"{1000 * diameter:.0f} mm at {limit / 1e3:.0f} kPa"
        yield f"{cup}: off at {pull:.1f} N, the law says {force:.1f} N"


def _sucked(diameter: float, limit: float) -> Cell:
    """A box of 0.5 kg that hangs on a suction cup."""
    robot = gen3().with_tool(suction_cup(diameter, ejector=Ejector(limit=limit)))
    box = Box(mass=0.5, size=(0.1, 0.1, 0.04), position=(0.5, 0.1, 1.0), jitter=0.0)
    cell = Cell(1, noise=False, scene=Scene(parts=(box,)), robot=robot)
    cell.arm.move_joints(DOWN)
    pose = cell.arm.commanded_pose()
    cell.arm.move_by(x=0.5 - pose.x, y=0.1 - pose.y)
    cell.arm.move_by(z=0.137 - pose.z)
    cell.suction.on()
    cell.wait(1)
    cell.arm.set_payload(2.0)  # within what the arm takes for a collision
    cell.arm.move_by(z=0.05, speed=0.1)
    return cell


def rolling() -> Iterator[str]:
    """How far a lying cylinder rolls in 0.5 s, and where boxes tip, by tilting gravity."""
    for degrees in (0.5, 3.0, 6.0):
        bar = Cylinder(position=(-0.6, 0.3, 0.76), angles=(90, 0, 0), jitter=0.0)
        cell, slope = Cell(1, scene=Scene(parts=(bar,))), math.radians(degrees)
        cell.simulation.model.opt.gravity[:] = (GRAVITY * math.sin(slope), 0, -GRAVITY * math.cos(slope))
        cell.wait(0.5)
        moved = float(cell.simulation.data.body("box").xpos[0]) + 0.6
        drive = max(0.0, math.sin(slope) - ROLLING / 0.025 * math.cos(slope))
        law = 2 / 3 * GRAVITY * drive * 0.5**2 / 2
        yield f"{degrees} deg: rolls {1000 * moved:.1f} mm, mechanics says {1000 * law:.1f} mm"
    for offset in (0.0, 0.01, 0.02):
        tall = Box(position=(-0.6, 0.3, 0.76), size=(0.05, 0.05, 0.2), centre_of_mass=(offset, 0, 0))
        for tenths in range(0, 300, 2):
            cell, slope = Cell(1, scene=Scene(parts=(tall,))), math.radians(tenths / 10)
            cell.simulation.model.opt.gravity[:] = (GRAVITY * math.sin(slope), 0, -GRAVITY * math.cos(slope))
            cell.wait(1.5)
            if cell.truth.box_tilt() > 45:
                break
        law = math.degrees(math.atan2(0.025 - offset, 0.1))
        yield f"mass {1000 * offset:.0f} mm off: tips from {tenths / 10} deg on, geometry says {law:.1f}"


def weighing() -> Iterator[str]:
    """The gripper's weight and its torque as the force sensor reads them, in four postures."""
    for angles in (DOWN, BEHIND, (0, 15, 180, -130, 0, 55, 90), (30, -20, 150, -80, 90, 30, -10)):
        cell = Cell(1, noise=False, scene=Scene(parts=()))
        cell.arm.move_joints(angles)
        cell.wait(1)
        wrench = cell.force_sensor.wrench()
        yield f"{wrench.force:.3f} N of {0.9 * GRAVITY:.3f} N, torque {wrench.tx:.3f} {wrench.ty:.3f} Nm"


def energy() -> Iterator[str]:
    """Energy of the arm that swings freely for 5 s from home, J."""
    model = build_arm(kinova.gen3())
    data = mujoco.MjData(model)
    data.qpos[:] = kinova.HOME
    data.qpos[1] += 0.5
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT | mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION
    model.body_gravcomp[:] = 0
    mujoco.mj_forward(model, data)
    start = float(data.energy.sum())
    moving, most = [], 0.0
    for _ in range(2500):
        mujoco.mj_step(model, data)
        moving.append(float(data.energy[1]))
        most = max(most, abs(float(data.energy.sum()) - start))
    yield f"most kinetic energy {max(moving):.1f} J, the total changes by {most:.2f} J at most"


FACTS: dict[str, Callable[[], Iterator[str]]] = {
    fact.__name__: fact
    for fact in (path, encoders, repeatability, coulomb, payload, holding, creep, rebound, limits, inertia,
                 friction, sensors, sight, suction, rolling, weighing, energy)
}  # fmt: skip


@contextmanager
def _told(name: str) -> Iterator[None]:
    print(f"{name}: {(FACTS[name].__doc__ or '').splitlines()[0]}", flush=True)
    yield


def main(names: list[str]) -> None:
    """Print the facts."""
    for name in names or FACTS:
        with _told(name):
            for line in FACTS[name]():
                print(f"    {line}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
