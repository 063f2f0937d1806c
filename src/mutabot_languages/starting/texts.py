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

RAPID_MODULE = """MODULE MissingData
  ! No file of the program declares these, so that they are as on a robot without tools: put in what is right.
{}
ENDMODULE
"""

RAPID_DATA = {
    "tooldata": "  PERS tooldata {}:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];",
    "wobjdata": '  PERS wobjdata {}:=[FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];',
}

KRL_CONFIG = """DEFDAT $CONFIG PUBLIC
; No file of the program declares these. They are as on a new controller: put in what is right.
{}
ENDDAT
"""

KRL_DATA = {
    "xhome": "DECL E6AXIS XHOME={A1 0,A2 -90,A3 90,A4 0,A5 0,A6 0}",
    "fhome": "DECL FDAT FHOME={TOOL_NO 0,BASE_NO 0,IPO_FRAME #BASE}",
    "pdefault": "DECL PDAT PDEFAULT={VEL 100,ACC 100,APO_DIST 100}",
    "ldefault": "DECL LDAT LDEFAULT={VEL 2,ACC 100,APO_DIST 100}",
}
