"""The texts of the files that `template` writes."""

from __future__ import annotations

CONFIGURATION = """program = ["program.py"]  # makes the robot's calls
tests = ["tests"]
vocabulary = ["cell"]  # comes with mutabot
rounds = 1
seed = 1
"""

KNOWN_ROBOT = '''"""The robot."""

from mutabot_cell import RobotModel, robots


def robot() -> RobotModel:
    """Arm and gripper."""
    return robots.{name}()
'''

ROBOT_OF_FILE = '''"""The robot."""

from pathlib import Path

from mutabot_cell import Limits, RobotModel, robots

HOME = None
"""Joint angles, degrees; None: the file's keyframe."""


def robot() -> RobotModel:
    """Arm and gripper. Say what its maker says: rad, s, and Nm if the file has no torques."""
    arm = RobotModel.from_{kind}(
        Path(__file__).parent / {path},
        {site}={tool},
        home=HOME,
        limits=Limits(speed=1.0, acceleration=5.0),
        payload=1.0,
    )
    return arm.with_tool(robots.gripper())
'''

CARRY = '''"""Carry a box from where the camera sees it to another place."""

from dataclasses import replace

from mutabot_cell import Cell

OPEN, CLOSED = 0, 1
BASE_HEIGHT = 0.9
"""Of the robot's base above the floor, m: the camera measures from the floor, the arm from its base."""
GRIP_HEIGHT = 0.025
"""Where the fingers hold the box, above its bottom, m."""
ABOVE, CLEARANCE = 0.15, 0.002
"""How high the gripper waits above its place, and how high it lets the box go, m."""


def run(cell: Cell, x: float, y: float) -> bool:
    """Set the box down at (x, y), world frame, m; False if it was not gripped. Ends at home."""
    box = cell.sensors.box_position()
    down = replace(cell.arm.commanded_pose(), theta_x=180, theta_y=0)
    bottom = box.z - BASE_HEIGHT + GRIP_HEIGHT
    cell.gripper.command(OPEN)
    cell.arm.move_to(replace(down, x=box.x, y=box.y, z=bottom + ABOVE))
    cell.arm.move_to(replace(down, x=box.x, y=box.y, z=bottom))
    cell.gripper.command(CLOSED, wait=True)
    held = cell.gripper.holding()
    cell.arm.move_to(replace(down, x=box.x, y=box.y, z=bottom + ABOVE))
    if held:
        cell.arm.move_to(replace(down, x=x, y=y, z=bottom + ABOVE))
        cell.arm.move_to(replace(down, x=x, y=y, z=bottom + CLEARANCE))
    cell.gripper.command(OPEN, wait=True)
    if held:
        cell.arm.move_to(replace(down, x=x, y=y, z=bottom + ABOVE))
    cell.arm.home()
    return held
'''

TEST_CARRY = '''"""Does the box end where it belongs?"""

import program
import pytest
from robot import robot

from mutabot_cell import Box, Scene
from mutabot_cell.fixtures import *  # noqa: F403  (new_cell)

PLACE = (0.45, -0.25)
WITHIN = 0.004
"""Of the place, m: the camera's noise is 0.0005, the program's and the test's reading add up."""


def test_the_box_is_carried_to_its_place(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed, robot=robot())
    cell.always(lambda: cell.truth.box_tilt() < 3, "the box stays upright")
    before = cell.sensors.box_position()

    assert program.run(cell, *PLACE)

    after = cell.sensors.box_position()
    assert (after.x, after.y) == pytest.approx(PLACE, abs=WITHIN)
    assert after.z == pytest.approx(before.z, abs=WITHIN)
    assert cell.gripper.opening() > 0.08


def test_where_the_box_cannot_be_gripped_the_program_says_so(new_cell, mutabot_seed):
    small = Box(size=(0.004, 0.004, 0.004))
    cell = new_cell(mutabot_seed, robot=robot(), scene=Scene(parts=(small,)))

    assert not program.run(cell, *PLACE)
'''

LINE = '''"""Go up and down again."""

from mutabot_cell import Cell

HEIGHT = 0.05
"""m"""


def run(cell: Cell) -> None:
    """Open the gripper, go up, close it, and come back."""
    cell.gripper.command(0, wait=True)
    cell.arm.move_by(z=HEIGHT)
    cell.gripper.command(1, wait=True)
    cell.arm.home()
'''

TEST_LINE = '''"""Does the tool go where it should, and come back?"""

import program
import pytest
from robot import robot

from mutabot_cell import Scene
from mutabot_cell.fixtures import *  # noqa: F403  (new_cell)

WITHIN = 0.002
"""m"""


def test_the_tool_goes_up_and_comes_back(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed, robot=robot(), scene=Scene(fixtures=(), marks=(), parts=()))
    start = cell.sensors.tool_pose()
    highest = [start.z]
    cell.simulation.after_tick.append(lambda: highest.append(cell.truth.tool_position().z))

    program.run(cell)

    end = cell.sensors.tool_pose()
    assert (end.x, end.y, end.z) == pytest.approx((start.x, start.y, start.z), abs=WITHIN)
    assert max(highest) == pytest.approx(start.z + 0.05, abs=WITHIN)
    assert cell.gripper.opening() < 0.005
'''

CONFTEST = '''"""The program lies beside the tests' folder."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
'''
