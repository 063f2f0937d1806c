"""Texts of the files that `project` makes."""

from __future__ import annotations

CONFIGURATION = """program = {program}  # makes the robot's calls
tests = ["tests"]
vocabulary = ["cell"]  # comes with mutabot
families = ["robot", "program-text"]
rounds = 1
seed = 1
"""

TEST = '''"""Does {program} do its task? The numbers are those of one run: put in what the task asks for."""

from pathlib import Path

import pytest

from mutabot_cell import Box, Scene, robots
from mutabot_cell.fixtures import *  # noqa: F403  (new_cell)
from mutabot_languages import load

ROOT = Path(__file__).parents[1]
{constants}

@pytest.fixture
def cell(new_cell, mutabot_seed):
    return new_cell(mutabot_seed, robot=robots.{arm}(), scene=Scene(parts=(Box(),)))


@pytest.fixture
def program():
    return load(ROOT / {first}{more})


def test_the_program_{name}(cell, program):
    program.run(cell{how})
{checks}'''

ENDS = '''SECONDS = {seconds}
"""The program takes no longer, s."""
TOOL = {tool}
"""Where the tool ends, robot base frame, m."""
'''

BOX = '''BOX = {box}
"""Where the box ends, world frame, m."""
WITHIN = 0.005
"""Of these places, m: what sensors and the feeder scatter adds up."""
'''

CHECK_TOOL = """\
    pose = cell.truth.tool_pose()
    assert (pose.x, pose.y, pose.z) == pytest.approx(TOOL, abs=WITHIN)
"""

CHECK_BOX = """\
    box = cell.truth.box_position()
    assert (box.x, box.y, box.z) == pytest.approx(BOX, abs=WITHIN)
"""
