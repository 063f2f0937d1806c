"""Motions that are decided tick by tick work for any arm that lines work for."""

from __future__ import annotations

import numpy as np
import pytest

from mutabot_cell import Cell, RobotModel, Scene
from mutabot_cell.scene import Belt


def test_any_arm_follows_a_belt_to_a_count_of_its_encoder_and_half_a_millimetre(robot: RobotModel) -> None:
    """As exactly as its servos follow: lines are kept within half a millimetre too."""
    cell = Cell(1, robot=robot, scene=Scene(parts=()))
    cell.belt().run(0.03)
    cell.wait(0.5)
    cell.arm.track(cell.belt())
    cell.wait(0.2)
    tool, belt = cell.truth.tool_position().y, cell.truth.belt_position()
    errors = []
    for _ in range(60):
        cell.simulation.tick()
        errors.append(cell.truth.tool_position().y - tool - (cell.truth.belt_position() - belt))
    assert np.abs(errors).max() < Belt().resolution + 0.0005
    cell.arm.move_by(z=0.02)
    cell.arm.stop_tracking()
    resting = cell.truth.tool_position()
    cell.wait(0.5)
    assert cell.truth.tool_position().y == pytest.approx(resting.y, abs=5e-4)


def test_a_move_of_any_arm_can_be_stopped_on_its_way(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=Scene(parts=()))
    start = np.array(cell.truth.tool_position())
    move = cell.arm.start_move_by(y=0.1)
    cell.wait(0.2)
    move.stop()
    cell.wait(0.3)
    moved = np.array(cell.truth.tool_position()) - start
    assert 0.002 < moved[1] < 0.098
    assert np.abs(moved[[0, 2]]).max() < 0.001
