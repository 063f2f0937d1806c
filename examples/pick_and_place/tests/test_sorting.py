"""Does every box end where it belongs, and does the robot notice when it does not?"""

from __future__ import annotations

from collections.abc import Callable

import pytest
import sorting
from monitors import CONVEYOR_TOP, TABLE_TOP
from readings import box_after, box_before, opening_after, tool_at_rest
from sorting import Outcome, Report

from mutabot_cell import Box, Cell, Pose

CellWith = Callable[..., Cell]

HOME = Pose(0.5767, 0.0014, 0.4337, 90.0, 0.0, 90.0)
"""Base frame; the maker's figures."""
HOME_WITHIN = 0.0015
"""The arm has arrived when every joint is within 0.001 rad: 0.9 mm at the end of 0.9 m. The rest is
five times the encoders' noise, 0.1 mm."""
HOME_WITHIN_DEGREES = 0.3
"""As above: 0.06° for each of the joints that can add up, and 0.02° of noise, five times."""

ON_CONVEYOR = (0.55, 0.20)
PLACED_WITHIN = 0.0035
"""Five times the noise of two cameras, the program's and the test's, which is 0.7 mm together."""
FOUND_WITHIN = 0.0035
"""The feeder's placement, at most 1 mm, and five times the camera's noise."""
RESTING_WITHIN = 0.0025
"""Of a box's height: five times the camera's noise."""
FULLY_OPEN = 0.085
OPEN_WITHIN = 0.001
CYCLE_TIME = {"red": 13.1, "blue": 12.7}
"""From home to home, s: what the program needs at most, rounded up. The box's place makes 0.1 s of it."""
ANOTHER_START, ANOTHER_GRIP = 0.1, 3.5
"""What it costs if the robot was left elsewhere, and if the box slips, s; rounded up as well."""
BUMP = 0.006
"""How far the box moves in the fingers of the robot that is bumped into, m."""


@pytest.mark.parametrize("colour", ["red", "blue"])
def test_a_box_is_set_down_at_the_place_of_its_colour(cell_with: CellWith, colour: str) -> None:
    cell = cell_with(Box(colour=colour))
    check_at_home(cell)
    check_found(cell, *ON_CONVEYOR)

    assert sorting.run(cell) == Report(Outcome.PLACED, colour, grips=1)

    assert cell.time < CYCLE_TIME[colour]
    check_placed(cell, colour)
    check_at_home(cell)


@pytest.mark.parametrize(("dx", "dy"), [(-0.10, -0.12), (0.07, 0.05), (-0.05, -0.40)])
def test_a_box_is_found_wherever_it_lies_on_the_conveyor(cell_with: CellWith, dx: float, dy: float) -> None:
    x, y = ON_CONVEYOR
    cell = cell_with(Box(position=(x + dx, y + dy, CONVEYOR_TOP), colour="red"))
    check_found(cell, x + dx, y + dy)

    assert sorting.run(cell) == Report(Outcome.PLACED, "red", grips=1)

    check_placed(cell, "red")
    check_at_home(cell)


def test_the_robot_may_have_been_left_anywhere_with_a_closed_gripper(cell_with: CellWith) -> None:
    cell = cell_with(Box(colour="blue"))
    leave_elsewhere(cell)
    start = cell.time

    assert sorting.run(cell) == Report(Outcome.PLACED, "blue", grips=1)

    assert cell.time - start < CYCLE_TIME["blue"] + ANOTHER_START
    check_placed(cell, "blue")
    check_at_home(cell)


def test_without_a_box_the_robot_goes_home_and_says_so(cell_with: CellWith) -> None:
    cell = cell_with()
    leave_elsewhere(cell)

    assert sorting.run(cell) == Report(Outcome.NO_BOX)

    check_at_home(cell)


def test_a_box_that_is_already_on_the_table_is_left_alone(cell_with: CellWith) -> None:
    cell = cell_with(Box(position=(-0.4, 0.28, TABLE_TOP)))

    assert sorting.run(cell) == Report(Outcome.NO_BOX)

    check_rests(cell, -0.4, 0.28, TABLE_TOP)
    check_at_home(cell)


def test_something_smaller_than_a_box_is_left_alone(cell_with: CellWith) -> None:
    cell = cell_with(Box(size=(0.025, 0.025, 0.025)))

    assert sorting.run(cell) == Report(Outcome.NO_BOX)

    check_rests(cell, *ON_CONVEYOR, CONVEYOR_TOP)
    check_at_home(cell)


def test_a_box_that_slips_is_gripped_again_and_firmer(cell_with: CellWith) -> None:
    cell = cell_with(Box(colour="red", mass=0.4, friction=0.04), slips=True)

    assert sorting.run(cell) == Report(Outcome.PLACED, "red", grips=2)

    assert cell.time < CYCLE_TIME["red"] + ANOTHER_GRIP
    check_placed(cell, "red")
    check_at_home(cell)


def test_a_box_that_slips_twice_is_left_on_the_conveyor(cell_with: CellWith) -> None:
    cell = cell_with(Box(colour="blue", mass=0.4, friction=0.01), slips=True)

    assert sorting.run(cell) == Report(Outcome.SLIPPED, "blue", grips=2)

    check_rests(cell, *ON_CONVEYOR, CONVEYOR_TOP)
    check_at_home(cell)


def test_a_box_that_is_bumped_in_the_fingers_is_still_set_down_in_its_place(cell_with: CellWith) -> None:
    cell = cell_with(Box(colour="blue"))
    box = cell.simulation.data.joint("box")

    def bump() -> None:
        if cell.truth.box_position().z > CONVEYOR_TOP + 0.1:
            box.qpos[0] += BUMP
            cell.simulation.after_tick.remove(bump)

    cell.simulation.after_tick.append(bump)

    assert sorting.run(cell) == Report(Outcome.PLACED, "blue", grips=1)

    check_placed(cell, "blue")
    check_at_home(cell)


def test_a_box_lost_on_the_way_is_noticed(cell_with: CellWith) -> None:
    cell = cell_with(Box(colour="red", mass=0.4, friction=0.06), gets_lost=True)

    def weaken() -> None:
        if cell.truth.tool_pose().x < 0.2:
            cell.gripper.set_force(20)

    cell.simulation.after_tick.append(weaken)

    assert sorting.run(cell) == Report(Outcome.LOST, "red", grips=1)

    check_at_home(cell)


def leave_elsewhere(cell: Cell) -> None:
    """Another program ended with the arm to the side and the gripper closed."""
    cell.arm.move_joints((60, 0, 180, -120, 0, 60, 90))
    cell.gripper.command(1, wait=True)


def check_found(cell: Cell, x: float, y: float) -> None:
    """The camera sees the box where the feeder put it."""
    box = box_before(cell)
    assert (box.x, box.y) == pytest.approx((x, y), abs=FOUND_WITHIN)
    assert box.z == pytest.approx(CONVEYOR_TOP, abs=RESTING_WITHIN)


def check_placed(cell: Cell, colour: str) -> None:
    """The box lies at the place of its colour."""
    check_rests(cell, *sorting.PLACES[colour], TABLE_TOP)


def check_rests(cell: Cell, x: float, y: float, z: float) -> None:
    """The box lies at this place."""
    box = box_after(cell)
    assert (box.x, box.y) == pytest.approx((x, y), abs=PLACED_WITHIN)
    assert box.z == pytest.approx(z, abs=RESTING_WITHIN)


def check_at_home(cell: Cell) -> None:
    """The arm stands at home, the gripper is open."""
    pose = tool_at_rest(cell)
    assert (pose.x, pose.y, pose.z) == pytest.approx((HOME.x, HOME.y, HOME.z), abs=HOME_WITHIN)
    angles = (pose.theta_x, pose.theta_y, pose.theta_z)
    assert angles == pytest.approx((HOME.theta_x, HOME.theta_y, HOME.theta_z), abs=HOME_WITHIN_DEGREES)
    assert opening_after(cell) == pytest.approx(FULLY_OPEN, abs=OPEN_WITHIN)
