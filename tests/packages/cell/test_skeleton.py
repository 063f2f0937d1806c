"""The lines by which a robot is drawn go from its base to what it holds."""

from __future__ import annotations

from collections.abc import Iterator
from math import dist

import numpy as np
import pytest

from mutabot.evidence import recorder
from mutabot.evidence.paths import RecordedPaths
from mutabot_cell import Cell, robots
from mutabot_cell.display.skeleton import skeleton_of
from mutabot_cell.models.robot import RobotModel


@pytest.fixture
def running() -> Iterator[recorder.WorldRecorder]:
    yield recorder.begin()
    recorder.stop()


def points(numbers: list[float]) -> list[list[float]]:
    return [numbers[start : start + 3] for start in range(0, len(numbers), 3)]


def lines(cell: Cell) -> dict[str, list[list[float]]]:
    robot = cell.simulation.robot
    return {line.name: points(line.read()) for line in skeleton_of(cell.simulation, robot)}


@pytest.mark.parametrize("robot", [None, robots.ur5e()], ids=["Gen3", "UR5e"])
def test_an_arm_is_drawn_from_its_base_to_its_gripper_with_every_joint(robot: RobotModel | None) -> None:
    cell = Cell(1, robot=robot)
    arm, fingers = lines(cell)["arm"], lines(cell)["fingers"]
    data, model = cell.simulation.data, cell.simulation.robot
    assert dist(arm[0], data.xpos[model.body]) < 1e-9
    for joint in model.model.joints:
        body = cell.simulation.model.joint(joint).bodyid[0]
        assert min(dist(data.xpos[body], point) for point in arm) < 1e-3, joint
    assert dist(arm[-1], np.mean(fingers, axis=0)) < 0.06
    assert dist(fingers[0], fingers[-1]) == pytest.approx(cell.truth.opening(), abs=0.02)


def test_fingers_that_close_are_drawn_closer(cell: Cell) -> None:
    before = lines(cell)["fingers"]
    cell.gripper.command(1.0)
    cell.wait(1.5)
    after = lines(cell)["fingers"]
    assert dist(after[0], after[-1]) < dist(before[0], before[-1]) - 0.05


def test_a_recording_of_a_cell_has_the_arm_as_lines_that_are_not_compared(
    cell: Cell, running: recorder.WorldRecorder
) -> None:
    cell.arm.move_by(z=-0.05)
    running.finish()
    found = RecordedPaths(running.recording)
    assert set(found.lines) == {"arm", "fingers"}
    assert not {*found.lines} & {*found.paths}
    moved = dist(*(points(list(found.lines["arm"].rows[row]))[-1] for row in (0, -1)))
    assert moved == pytest.approx(0.05, abs=0.005)
