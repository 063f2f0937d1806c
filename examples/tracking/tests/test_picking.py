"""Does every box that comes end in its row, and does the robot notice when one does not?

Short tests come first: they end most mutants.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import picking
import pytest
from monitors import BELT_TOP, TABLE_TOP
from picking import Report
from readings import belt_speed_after, belt_travel_after, box_after, opening_after, tool_after

from mutabot_cell import Box, Cell, Pose

CellWith = Callable[..., Cell]

HOME = Pose(0.5767, 0.0014, 0.4337, 90.0, 0.0, 90.0)
"""Base frame; the maker's figures."""
HOME_WITHIN, HOME_WITHIN_DEGREES = 0.0015, 0.3
"""As in ../pick_and_place."""
PLACED_WITHIN = 0.0035
"""Five times the noise of two cameras, the program's and the test's, which is 0.7 mm together."""
RESTING_WITHIN = 0.0025
"""Of a box's height: five times the camera's noise."""
FULLY_OPEN, OPEN_WITHIN = 0.085, 0.001
STANDING = 0.0015
"""The belt stands when its encoder counts less than this, m/s: a count of 0.1 mm in 0.1 s, and a half."""
UPSTREAM = Box(name="box 1", position=(0.5, -0.3, BELT_TOP))
CYCLE_TIME = 18.2
"""From the start to home for UPSTREAM, if it is red, s: what the program needs at most, rounded up; that the
belt wanders makes 0.2 s of it."""
GAP = 0.13
"""Between boxes that follow each other closely, m: the gripper is 0.1 wide and needs the rest to open."""


def test_without_boxes_the_belt_does_not_start_wherever_the_robot_was_left(cell_with: CellWith) -> None:
    cell = cell_with()
    cell.arm.move_joints((60, 0, 180, -120, 0, 60, 90))
    cell.gripper.command(1, wait=True)

    assert picking.run(cell, []) == Report([], [])

    assert belt_travel_after(cell) == 0.0
    check_at_rest(cell)


@pytest.mark.parametrize("place", [(0.75, -0.3, BELT_TOP), (0.3, -0.3, BELT_TOP), (-0.35, 0.28, TABLE_TOP)])
def test_what_the_gripper_does_not_reach_or_is_not_on_the_belt_is_left_alone(
    cell_with: CellWith, place: tuple[float, float, float]
) -> None:
    cell = cell_with(replace(UPSTREAM, position=place))

    assert picking.run(cell, ["box 1"]) == Report([], [])

    assert belt_travel_after(cell) == 0.0
    check_rests(cell, "box 1", *place)
    check_at_rest(cell)


def test_something_lower_than_a_box_is_left_on_the_belt(cell_with: CellWith) -> None:
    low = replace(UPSTREAM, size=(0.05, 0.05, 0.025))
    cell = cell_with(low, troubled=("box 1",))

    assert picking.run(cell, ["box 1"]) == Report([], ["box 1"])

    check_on_belt(cell, "box 1")
    check_at_rest(cell)


def test_a_box_that_is_taken_away_under_the_gripper_is_reported(cell_with: CellWith) -> None:
    cell = cell_with(replace(UPSTREAM, colour="red"), troubled=("box 1",))
    joint = cell.simulation.data.joint("box 1")

    def take_away() -> None:
        if cell.arm.is_tracking():
            joint.qpos[1] -= 0.3
            cell.simulation.after_tick.remove(take_away)

    cell.simulation.after_tick.append(take_away)

    assert picking.run(cell, ["box 1"]) == Report([], ["box 1"])

    check_on_belt(cell, "box 1")
    check_at_rest(cell)


def test_a_box_is_picked_from_the_moving_belt_and_set_down_in_time(cell_with: CellWith) -> None:
    cell = cell_with(replace(UPSTREAM, colour="red"))

    assert picking.run(cell, ["box 1"]) == Report(["red"], [])

    assert cell.time < CYCLE_TIME
    check_placed(cell, "box 1", "red", 0)
    check_at_rest(cell)


def test_a_box_lost_on_the_way_is_reported(cell_with: CellWith) -> None:
    cell = cell_with(replace(UPSTREAM, colour="red", mass=0.4, friction=0.06), troubled=("box 1",))
    cell.gripper.set_force(160)

    def weaken() -> None:
        if cell.truth.tool_pose().x < 0.2:
            cell.gripper.set_force(20)

    cell.simulation.after_tick.append(weaken)

    assert picking.run(cell, ["box 1"]) == Report([], ["box 1"])

    check_at_rest(cell)


def test_a_box_that_is_bumped_in_the_fingers_is_still_set_down_in_its_place(cell_with: CellWith) -> None:
    cell = cell_with(replace(UPSTREAM, colour="blue"))
    joint = cell.simulation.data.joint("box 1")

    def bump() -> None:
        if cell.truth.box_position("box 1").z > BELT_TOP + 0.1:
            joint.qpos[0] += 0.006
            cell.simulation.after_tick.remove(bump)

    cell.simulation.after_tick.append(bump)

    assert picking.run(cell, ["box 1"]) == Report(["blue"], [])

    check_placed(cell, "box 1", "blue", 0)
    check_at_rest(cell)


def test_a_box_that_the_belt_does_not_bring_is_reported(cell_with: CellWith) -> None:
    cell = cell_with(replace(UPSTREAM, friction=0.0))

    assert picking.run(cell, ["box 1"]) == Report([], ["box 1"])

    assert cell.time < picking.LONGEST_WAIT + 7.0
    check_on_belt(cell, "box 1")
    check_at_rest(cell)


def test_a_box_that_slips_out_of_the_fingers_is_reported_and_the_next_one_picked(cell_with: CellWith) -> None:
    slippery = replace(UPSTREAM, colour="red", mass=0.4, friction=0.01)
    after = Box(name="box 2", position=(0.5, -0.6, BELT_TOP), colour="blue")
    cell = cell_with(slippery, after, troubled=("box 1",))

    assert picking.run(cell, names(2)) == Report(["blue"], ["box 1"])

    check_placed(cell, "box 2", "blue", 0)
    check_at_rest(cell)


def test_the_belt_waits_for_boxes_that_follow_closely(cell_with: CellWith) -> None:
    colours = ["blue", "red"]
    cell = cell_with(*row(colours, gap=GAP, first=(0.48, -0.3)))

    assert picking.run(cell, names(2)) == Report(colours, [])

    for name, colour in zip(names(2), colours, strict=True):
        check_placed(cell, name, colour, 0)
    assert 0.17 < belt_travel_after(cell) < 0.45  # the second box has 0.18 to come to where it is picked
    check_at_rest(cell)


def test_boxes_anywhere_across_the_belt_are_sorted_while_it_runs_on_unevenly(cell_with: CellWith) -> None:
    colours = ["red", "red"]
    cell = cell_with(*row(colours, gap=0.95, first=(0.40, -0.2), step_x=0.18), jitter=0.15)
    stops = count_stops(cell)

    assert picking.run(cell, names(2)) == Report(colours, [])

    assert stops == [1], "only at the end"
    for before, name in enumerate(names(2)):
        check_placed(cell, name, "red", before)
    check_at_rest(cell)


def names(count: int) -> list[str]:
    """Of a batch of so many boxes, the foremost first."""
    return [f"box {number}" for number in range(1, count + 1)]


def row(colours: list[str], gap: float, first: tuple[float, float], step_x: float = 0.0) -> list[Box]:
    """Boxes one behind the other."""
    x, y = first
    return [
        Box(name=name, position=(x + step_x * index, y - gap * index, BELT_TOP), colour=colour)
        for index, (name, colour) in enumerate(zip(names(len(colours)), colours, strict=True))
    ]


def count_stops(cell: Cell) -> list[int]:
    """How often the belt comes to rest from now on."""
    stops, speeds = [0], [0.0]

    def note() -> None:
        speed = cell.truth.belt_speed()
        stops[0] += speed == 0.0 != speeds[0]
        speeds[0] = speed

    cell.simulation.after_tick.append(note)
    return stops


def check_placed(cell: Cell, name: str, colour: str, before: int) -> None:
    """The box lies in the row of its colour behind so many others."""
    x = picking.FIRST_IN_ROW + before * picking.ROW_STEP
    check_rests(cell, name, x, picking.ROWS[colour], TABLE_TOP)


def check_rests(cell: Cell, name: str, x: float, y: float, z: float) -> None:
    """The box lies at this place."""
    box = box_after(cell, name)
    assert (box.x, box.y) == pytest.approx((x, y), abs=PLACED_WITHIN)
    assert box.z == pytest.approx(z, abs=RESTING_WITHIN)


def check_on_belt(cell: Cell, name: str) -> None:
    """The box lies on the belt."""
    assert box_after(cell, name).z == pytest.approx(BELT_TOP, abs=RESTING_WITHIN)


def check_at_rest(cell: Cell) -> None:
    """The arm stands at home, the gripper is open, the belt stands."""
    pose = tool_after(cell)
    assert (pose.x, pose.y, pose.z) == pytest.approx((HOME.x, HOME.y, HOME.z), abs=HOME_WITHIN)
    angles = (pose.theta_x, pose.theta_y, pose.theta_z)
    assert angles == pytest.approx((HOME.theta_x, HOME.theta_y, HOME.theta_z), abs=HOME_WITHIN_DEGREES)
    assert opening_after(cell) == pytest.approx(FULLY_OPEN, abs=OPEN_WITHIN)
    assert belt_speed_after(cell) == pytest.approx(0.0, abs=STANDING)
