"""The published scenario, over ROS: the mission runs as a node in a process of its own."""

from __future__ import annotations

import subprocess
import sys

import pytest

rospy = pytest.importorskip("rospy", reason="no rospy: install Debian's python3-rospy, see README.md")

from expected import HOME, ON_CONVEYOR, TARGETS, is_within  # noqa: E402
from sensors import box_end_position, box_start_position, robot_home_position  # noqa: E402

from conftest import ROOT  # noqa: E402

MISSION = 60.0
"""How long the mission may take, s."""


@pytest.mark.usefixtures("cell")
def test_the_box_goes_to_the_target_of_its_colour() -> None:
    robot = robot_home_position()
    assert is_within(HOME.x, robot.x, 0.02)
    assert is_within(HOME.y, robot.y, 0.02)
    assert is_within(HOME.z, robot.z, 0.02)
    box = box_start_position()
    assert is_within(ON_CONVEYOR.x, box.x, 0.01)
    assert is_within(ON_CONVEYOR.y, box.y, 0.01)
    assert is_within(ON_CONVEYOR.z, box.z, 0.01)

    mission = subprocess.run([sys.executable, "mission.py"], cwd=ROOT, timeout=MISSION, check=False)
    assert mission.returncode == 0

    target = TARGETS[rospy.get_param("/cell/colour")]
    box = box_end_position()
    assert is_within(target.x, box.x, 0.02)
    assert is_within(target.y, box.y, 0.02)
    assert is_within(target.z, box.z, 0.02)
