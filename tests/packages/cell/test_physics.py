"""The cell obeys what physics, the robot's maker and materials say; each expectation is derived here."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mutabot_cell import Cell
from mutabot_cell.geometry import pose_of
from mutabot_cell.models import kinova
from mutabot_cell.motion.kinematics import Kinematics

SHOULDER_HEIGHT = kinova.JOINTS[0].origin[2] - kinova.JOINTS[1].origin[2]
"""Of joint 2's axis above the base, m; the axis lies across, and at home the arm reaches straight forward."""


def test_tool_pose_is_that_of_the_joint_angles_the_encoders_read(cell: Cell) -> None:
    cell.arm.move_by(y=0.1)
    for _ in range(5):
        cell.simulation.tick()
        seen = cell.sensors.tool_pose()
        computed = pose_of(*Kinematics().tool(np.radians(cell.sensors.joint_angles())))
        assert (seen.x, seen.y, seen.z) == pytest.approx((computed.x, computed.y, computed.z), abs=1e-9)


def test_a_wrongly_calibrated_joint_moves_the_tool_but_not_what_the_encoders_say(exact_cell: Cell) -> None:
    error = math.radians(1.0)
    before = exact_cell.truth.tool_position()
    exact_cell.simulation.set_encoder_error((0.0, error, 0.0, 0.0, 0.0, 0.0, 0.0))
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
    exact_cell.simulation.set_encoder_error((0.01, -0.01, 0.02, 0.0, 0.0, 0.0, 0.03))
    exact_cell.wait(1.0)
    assert exact_cell.sensors.joint_angles() == pytest.approx(read, abs=0.01)
