"""The cell obeys what physics, the robot's maker and materials say; each expectation is derived here."""

from __future__ import annotations

import math
from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from mutabot_cell import BadArgument, Box, Cell, Fixture, MotionRefused, ProtectiveStop, Scene, SensorError
from mutabot_cell.geometry import pose_of
from mutabot_cell.models import kinova
from mutabot_cell.models.assembly import build_arm
from mutabot_cell.models.options import PHYSICS_STEP
from mutabot_cell.motion.kinematics import Kinematics
from mutabot_cell.scene import CONVEYOR

SHOULDER_HEIGHT = kinova.JOINTS[0].origin[2] - kinova.JOINTS[1].origin[2]
"""Of joint 2's axis above the base, m; the axis lies across, and at home the arm reaches straight forward."""
GRAVITY = 9.81
DOWN = (0.0, 26.0, 180.0, -78.0, 0.0, -76.0, 90.0)
BEHIND = (-145.0, *DOWN[1:])
"""Joint angles, degrees: the gripper looks down, over the conveyor and over the table."""

STRETCHED = (0.0, 90.0, 180.0, 0.0, 0.0, 0.0, 90.0)
"""Joint angles, degrees: the arm stretched out, level."""


def with_box(mass: float, friction: float | None = None) -> Cell:
    return Cell(1, scene=Scene(parts=(Box(mass=mass, friction=friction, jitter=0.0),)))


def grip_from_above(cell: Cell, force: float = 60.0) -> None:
    """Close the fingers on the middle of the box on the conveyor."""
    box = cell.truth.box_position()
    cell.arm.move_joints(DOWN)
    pose = cell.arm.commanded_pose()
    cell.arm.move_by(x=box.x - pose.x, y=box.y - pose.y)
    cell.arm.move_by(z=box.z + 0.03 - 0.9 - pose.z)
    cell.gripper.set_force(force)
    cell.gripper.command(1, wait=True)


def place_in_tool(cell: Cell) -> tuple[float, ...]:
    """Where the box is in the tool's frame, m."""
    data, simulation = cell.simulation.data, cell.simulation
    site = simulation.id_of("site", "tool")
    away = data.xpos[simulation.id_of("body", "box")] - data.site_xpos[site]
    return tuple((data.site_xmat[site].reshape(3, 3).T @ away).tolist())


def test_tool_pose_is_that_of_the_joint_angles_the_encoders_read(cell: Cell) -> None:
    cell.arm.move_by(y=0.1)
    for _ in range(5):
        cell.simulation.tick()
        seen = cell.sensors.tool_pose()
        computed = pose_of(*Kinematics(kinova.gen3()).tool(np.radians(cell.sensors.joint_angles())))
        assert (seen.x, seen.y, seen.z) == pytest.approx((computed.x, computed.y, computed.z), abs=1e-9)


def test_a_wrongly_calibrated_joint_moves_the_tool_but_not_what_the_encoders_say(exact_cell: Cell) -> None:
    error = math.radians(1.0)
    before = exact_cell.truth.tool_position()
    exact_cell.simulation.robot.set_encoder_error((0.0, error, 0.0, 0.0, 0.0, 0.0, 0.0))
    exact_cell.arm.move_by(z=0.1)
    exact_cell.arm.home()
    exact_cell.wait(0.5)
    seen, now = exact_cell.sensors.tool_pose(), exact_cell.truth.tool_position()
    assert (seen.x, seen.z) == pytest.approx((before.x, before.z), abs=2e-4)
    lever = math.hypot(before.x, before.z - SHOULDER_HEIGHT)
    moved = math.dist((before.x, before.y, before.z), (now.x, now.y, now.z))
    assert moved == pytest.approx(2 * lever * math.sin(error / 2), abs=4e-4)


def test_joints_stand_still_when_only_the_calibration_changes(exact_cell: Cell) -> None:
    read = exact_cell.sensors.joint_angles()
    exact_cell.simulation.robot.set_encoder_error((0.01, -0.01, 0.02, 0.0, 0.0, 0.0, 0.03))
    exact_cell.wait(1.0)
    turned = np.array(exact_cell.sensors.joint_angles()) - read
    assert np.abs((turned + 180) % 360 - 180).max() < 0.01


@pytest.mark.parametrize("mass", [0.1, 0.5, 1.0])
def test_a_box_that_hangs_still_in_the_fingers_is_reported_as_held_at_every_tick(
    mass: float, grip: Callable[[Cell], None]
) -> None:
    cell = with_box(mass)
    grip(cell)
    cell.arm.move_by(z=0.1)
    cell.arm.move_joints(BEHIND)
    cell.wait(0.3)
    place = place_in_tool(cell)
    reports = []
    for _ in range(300):
        cell.simulation.tick()
        reports.append(cell.gripper.holding())
    assert math.dist(place, place_in_tool(cell)) < 0.001
    assert all(reports)


def test_fingers_that_open_report_once_that_they_hold_nothing(
    cell: Cell, grip: Callable[[Cell], None]
) -> None:
    grip(cell)
    cell.gripper.command(0)
    reports = [cell.gripper.holding()]
    for _ in range(100):
        cell.simulation.tick()
        reports.append(cell.gripper.holding())
    assert reports.index(False) <= 5
    assert not any(reports[reports.index(False) :])


@pytest.mark.parametrize("mass", [0.1, 1.0])
def test_static_friction_keeps_a_box_in_its_place_between_the_pads_while_the_arm_moves(mass: float) -> None:
    cell = with_box(mass)
    grip_from_above(cell, force=60.0)
    assert mass * (GRAVITY + kinova.TOOL_ACCELERATION) < 2 * 60.0 * 0.7, "Coulomb: far from slipping"
    for move in ({"z": 0.2}, {"y": -0.4}, {"theta_z": 60.0}, {"x": -0.1, "y": 0.2}):
        before = place_in_tool(cell)
        cell.arm.move_by(**move)
        assert math.dist(before, place_in_tool(cell)) < 0.0005
    before = place_in_tool(cell)
    cell.arm.move_joints(BEHIND)
    assert math.dist(before, place_in_tool(cell)) < 0.0005


@pytest.mark.parametrize("mass", [0.1, 0.5])
def test_a_box_slips_exactly_where_coulomb_says(mass: float) -> None:
    force, acceleration = 60.0, 0.2
    needed = mass * (GRAVITY + acceleration) / (2 * force)
    heights = []
    for friction in (0.9 * needed, 1.15 * needed):
        cell = with_box(mass, friction)
        grip_from_above(cell, force)
        cell.arm.move_by(z=0.1, speed=0.05)
        heights.append(cell.truth.box_position().z)
    assert heights[0] < 1.02
    assert heights[1] > 1.08


@pytest.mark.parametrize("mass", [0.1, 1.0, 2.0, 4.0])
def test_a_declared_part_up_to_the_rated_load_is_carried_without_sagging(mass: float) -> None:
    cell = with_box(mass)
    grip_from_above(cell, force=235.0)
    cell.arm.set_payload(mass)
    cell.arm.move_by(z=0.15)
    cell.arm.move_by(theta_z=60)
    cell.arm.move_joints(BEHIND)
    cell.wait(0.5)
    wanted, tool = cell.arm.commanded_pose(), cell.truth.tool_position()
    assert math.dist((wanted.x, wanted.y, wanted.z), (tool.x, tool.y, tool.z)) < 0.0005
    assert cell.truth.box_position().z > 1.1
    arm = float(cell.simulation.data.qfrc_actuator[1])
    box = cell.truth.box_position()
    part = mass * GRAVITY * math.hypot(box.x, box.y)
    empty = Cell(1)
    empty.arm.move_joints(BEHIND)
    empty.wait(0.5)
    assert abs(arm) == pytest.approx(abs(empty.simulation.data.qfrc_actuator[1]) + part, abs=0.1)


def test_a_heavy_part_that_nobody_declared_looks_like_a_collision() -> None:
    cell = with_box(4.0)
    grip_from_above(cell, force=235.0)
    with pytest.raises(ProtectiveStop):
        cell.arm.move_by(z=0.15)


def test_the_motors_carry_the_makers_loads_at_full_reach_for_as_long_as_it_says() -> None:
    """User guide: 1.1 kg without end, 4.5 kg for a while. The gripper of 0.9 kg is a part of the load."""
    cell = Cell(1, scene=Scene(parts=()))
    cell.arm.move_joints(STRETCHED)
    cell.wait(60.0)
    assert abs(cell.simulation.data.qfrc_actuator[1]) < kinova.JOINTS[1].torque
    gripper = cell.simulation.model.body("gripper")
    gripper.mass[:] += 4.5 - 0.9  # its weight is known to the controller
    start = cell.time
    cell.wait(5.0)
    assert kinova.JOINTS[1].torque < abs(cell.simulation.data.qfrc_actuator[1]) < kinova.JOINTS[1].peak_torque
    with pytest.raises(ProtectiveStop, match="joint 2 is overloaded") as stop:
        cell.wait(60.0)
    assert stop.value.overload == kinova.JOINTS[1].torque
    assert cell.time - start > 5.0
    gripper.mass[:] = 0.74
    cell.wait(60.0)
    cell.arm.acknowledge_stop()
    cell.arm.home()


@pytest.mark.parametrize("mass", [-0.1, 4.1, math.nan, "1", None])
def test_a_payload_that_the_arm_is_not_rated_for_is_refused(cell: Cell, mass: object) -> None:
    with pytest.raises(BadArgument, match="payload"):
        cell.arm.set_payload(mass)  # type: ignore[arg-type]


@pytest.mark.parametrize(("joint", "limit"), [(2, 128.9), (4, 147.8), (6, 120.3)])
def test_joints_turn_as_far_as_the_makers_guide_says_and_no_further(
    cell: Cell, joint: int, limit: float
) -> None:
    angles = list(kinova.HOME_DEGREES)
    angles[joint - 1] = -limit - 0.2
    with pytest.raises(MotionRefused, match=rf"0\.2 deg beyond its limit of -{limit} deg"):
        cell.arm.move_joints(angles)
    low, high = cell.simulation.model.joint(f"joint {joint}").range
    assert (math.degrees(low), math.degrees(high)) == pytest.approx((-limit, limit))


def test_links_weigh_on_the_joints_as_the_makers_description_says(cell: Cell) -> None:
    """The torque of joint 2 that gravity asks for, from the table of link masses and centres."""
    empty = build_arm(kinova.gen3())
    data = mujoco.MjData(empty)
    empty.body_gravcomp[:] = 0
    generator = np.random.default_rng(3)
    for _ in range(10):
        data.qpos[:] = generator.uniform(-2, 2, 7)
        mujoco.mj_forward(empty, data)
        axis, anchor = data.xaxis[1], data.xanchor[1]
        torque = 0.0
        for number, joint in enumerate(kinova.JOINTS, 1):
            frame = data.xmat[empty.body(f"link {number}").id].reshape(3, 3)
            place = data.xpos[empty.body(f"link {number}").id] + frame @ np.array(joint.centre)
            if number > 1:
                torque += float(np.cross(place - anchor, (0, 0, -joint.mass * GRAVITY)) @ axis)
        assert -data.qfrc_bias[1] == pytest.approx(torque, abs=1e-3)


def test_inertias_are_those_of_bodies_that_exist() -> None:
    """Positive, and no principal moment exceeds the sum of the other two."""
    for joint in kinova.JOINTS:
        xx, yy, zz, xy, xz, yz = joint.inertia
        smallest, middle, largest = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        assert smallest > 0
        assert largest <= (smallest + middle) * 1.01
        assert largest < joint.mass * 0.12**2, "within a link's length"


def test_dry_friction_in_the_joints_is_not_taken_for_a_collision(cell: Cell) -> None:
    friction = 25.0
    cell.simulation.model.dof_frictionloss[:2] = friction
    assert friction > kinova.EXTERNAL_TORQUE_LIMIT[0]
    most = 0.0

    def note() -> None:
        nonlocal most
        most = max(most, abs(float(cell.simulation.data.qfrc_constraint[0])))

    cell.simulation.after_tick.append(note)
    cell.arm.move_joints((30, 0, 180, -120, 0, 60, 90))
    assert most == pytest.approx(friction, rel=0.05), "Coulomb: while it turns, friction is all there"


def test_a_collision_still_stops_an_arm_whose_joints_rub(cell: Cell) -> None:
    cell.simulation.model.dof_frictionloss[:4] = 5.0
    cell.arm.move_by(y=-0.2)
    cell.arm.move_by(theta_x=80)
    with pytest.raises(ProtectiveStop, match="touched conveyor"):
        cell.arm.move_by(z=-0.4)


@pytest.mark.parametrize("height", [0.1, 0.2, 0.3])
def test_a_dropped_box_rebounds_a_little_and_comes_to_rest_on_the_surface(height: float) -> None:
    """Cardboard on rubber gives back a tenth or two of the speed. Steps let it in by what it falls in two."""
    cell = Cell(1, scene=Scene(parts=(Box(position=(0.55, 0.6, 1.0 + height), jitter=0.0),)))
    data, body = cell.simulation.data, cell.simulation.id_of("body", "box")
    heights = []
    for _ in range(1000):
        mujoco.mj_step(cell.simulation.model, data)
        heights.append(float(data.xpos[body][2]) - 0.025 - 1.0)
    landed = next(index for index, low in enumerate(heights) if low < 0.0)
    assert landed * PHYSICS_STEP == pytest.approx(math.sqrt(2 * height / GRAVITY), abs=0.01)
    lowest = landed + int(np.argmin(heights[landed : landed + 25]))
    speed = math.sqrt(2 * GRAVITY * height)
    assert -heights[lowest] < 2 * speed * PHYSICS_STEP
    restitution = math.sqrt(max(0.0, *heights[lowest:]) / height)
    assert restitution < 0.3
    assert max(heights[lowest:]) < height, "it gains no energy"
    assert heights[-1] == pytest.approx(0.0, abs=1e-4)
    assert abs(float(data.qvel[-4])) < 1e-3


def test_some_drops_rebound() -> None:
    tops = []
    for height in (0.15, 0.2, 0.25, 0.3, 0.35):
        cell = Cell(1, scene=Scene(parts=(Box(position=(0.55, 0.6, 1.0 + height), jitter=0.0),)))
        data, body = cell.simulation.data, cell.simulation.id_of("body", "box")
        cell.wait(math.sqrt(2 * height / GRAVITY) + 0.03)
        most = 0.0
        for _ in range(100):
            cell.simulation.tick()
            most = max(most, float(data.xpos[body][2]) - 1.025)
        tops.append(math.sqrt(most / height))
    assert 0.05 < sum(tops) / len(tops) < 0.3


@pytest.mark.parametrize(
    "fixture", [CONVEYOR, Fixture("plate", CONVEYOR.size, CONVEYOR.centre, friction=0.3)]
)
def test_a_box_slides_down_a_slope_whose_tangent_exceeds_its_friction(fixture: Fixture) -> None:
    """Gravity is tilted instead of the surface; the box travels as Coulomb says once it slides."""
    box = Box(position=(0.55, 0.6, 1.0), jitter=0.0)
    steepest = math.atan(fixture.friction)
    for slope in (steepest - math.radians(2), steepest + math.radians(4)):
        cell = Cell(1, scene=Scene(fixtures=(fixture,), parts=(box,)))
        cell.simulation.model.opt.gravity[:] = (0, -GRAVITY * math.sin(slope), -GRAVITY * math.cos(slope))
        cell.wait(0.5)
        drive = max(0.0, math.sin(slope) - fixture.friction * math.cos(slope)) * GRAVITY
        assert 0.6 - cell.truth.box_position().y == pytest.approx(drive * 0.5**2 / 2, rel=0.1, abs=0.001)


def test_an_oily_box_slides_on_everything_alike() -> None:
    cell = with_box(0.1, friction=0.05)
    slope = math.atan(0.1)
    cell.simulation.model.opt.gravity[:] = (0, -GRAVITY * math.sin(slope), -GRAVITY * math.cos(slope))
    cell.wait(0.5)
    assert cell.truth.box_position().y < 0.2 - 0.03


def test_dry_cardboard_on_silicone_carries_what_coulomb_says() -> None:
    """20 N carry 2.5 kg, but not with half of the friction."""
    mass, force = 2.5, 20.0
    assert 2 * force * 0.7 / 2 < mass * GRAVITY < 2 * force * 0.7
    cell = Cell(1, scene=Scene(parts=(Box(mass=mass),)))
    grip_from_above(cell, force)
    cell.arm.move_by(z=0.1, speed=0.05)
    assert cell.truth.box_position().z > 1.09


def test_readings_at_one_instant_are_one_reading(cell: Cell) -> None:
    """Asking more often than a device measures makes nothing more exact."""
    cell.wait(0.1)
    for read in (
        cell.sensors.box_position,
        cell.sensors.tool_pose,
        cell.sensors.joint_angles,
        cell.sensors.distance,
        cell.gripper.opening,
    ):
        assert len({read() for _ in range(100)}) == 1


def test_the_camera_sees_25_pictures_a_second_of_what_was_40_ms_ago(exact_cell: Cell) -> None:
    speed = 0.5
    box = exact_cell.simulation.data.joint("box")
    exact_cell.simulation.model.pair_friction[:] = 0
    exact_cell.simulation.model.geom_friction[:] = 0
    exact_cell.wait(0.2)
    box.qvel[1] = -speed
    exact_cell.wait(0.2)
    ages, seen = [], set()
    for _ in range(100):
        exact_cell.simulation.tick()
        reading = exact_cell.sensors.box_position().y
        ages.append((reading - exact_cell.truth.box_position().y) / speed)
        seen.add(reading)
    assert len(seen) in (25, 26)
    assert (min(ages), max(ages)) == pytest.approx((0.04, 0.07), abs=0.005)


def walls(*sides: str) -> tuple[Fixture, ...]:
    """Walls around the box on the conveyor, and a lid above it."""
    places = {
        "+y": (0.55, 0.3, 1.15),
        "-y": (0.55, 0.1, 1.15),
        "+x": (0.65, 0.2, 1.15),
        "-x": (0.45, 0.2, 1.15),
    }
    sizes = {"y": (0.3, 0.01, 0.3), "x": (0.01, 0.3, 0.3)}
    around = [Fixture(f"wall {side}", sizes[side[1]], places[side]) for side in sides if side != "lid"]
    return (*around, *([Fixture("lid", (0.4, 0.4, 0.01), (0.55, 0.2, 1.31))] if "lid" in sides else []))


def test_the_camera_does_not_see_through_things() -> None:
    hood = walls("+y", "-y", "+x", "-x", "lid")
    cell = Cell(1, scene=Scene(fixtures=(CONVEYOR, *hood)))
    with pytest.raises(SensorError, match="something is in the way"):
        cell.sensors.box_position()


def test_what_stands_behind_a_box_does_not_hide_it() -> None:
    """The camera stands in front of the robot, a little to the left."""
    cell = Cell(1, scene=Scene(fixtures=(CONVEYOR, *walls("-y", "-x"))))
    assert cell.sensors.box_position().y == pytest.approx(0.2, abs=0.005)


def test_the_camera_sees_a_box_in_the_fingers(cell: Cell) -> None:
    grip_from_above(cell)
    cell.arm.move_by(z=0.2)
    cell.wait(0.2)
    assert cell.sensors.box_position().z == pytest.approx(1.2, abs=0.004)
