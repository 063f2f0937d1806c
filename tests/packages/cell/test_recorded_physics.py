"""What a recording of the cell says of heights and speeds agrees with the physics at every control tick."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from mutabot.evidence import recorder
from mutabot.evidence.measurements import LEAST
from mutabot.evidence.paths import RecordedPaths
from mutabot.evidence.physics import IMPACT, MARGIN, RELEASE, SLIP, Fact, facts_of
from mutabot_cell import Cell

from .conftest import _grip


@pytest.fixture
def running() -> Iterator[recorder.WorldRecorder]:
    yield recorder.begin()
    recorder.stop()


def dropped(
    cell: Cell, height: float, running: recorder.WorldRecorder
) -> tuple[dict[tuple[str, str], Fact], list[float]]:
    """What is measured of a box that is lifted and let go, and how fast it was at each tick, m/s."""
    _grip(cell)
    cell.arm.move_by(z=height)
    body = cell.simulation.id_of("body", "box")
    dofs = slice(
        int(cell.simulation.model.body_dofadr[body]), int(cell.simulation.model.body_dofadr[body]) + 3
    )
    speeds: list[float] = []
    cell.simulation.after_tick.append(
        lambda: speeds.append(float(np.linalg.norm(cell.simulation.data.qvel[dofs])))
    )
    cell.gripper.command(0)
    cell.wait(1.5)
    running.finish()
    return facts_of(RecordedPaths(running.recording)), speeds


@pytest.mark.parametrize("height", [0.1, 0.15, 0.3])
def test_a_box_hits_the_conveyor_as_fast_as_the_recording_says(
    cell: Cell, height: float, running: recorder.WorldRecorder
) -> None:
    found, speeds = dropped(cell, height, running)
    assert found[RELEASE, "box"].value == pytest.approx(height, abs=0.01)
    assert found[RELEASE, "box"].other == "conveyor"
    # fingers that open hold back a little: the speed is right to the least difference that is told
    assert found[IMPACT, "box"].value == pytest.approx(max(speeds), abs=LEAST[IMPACT])
    assert found[SLIP, "box"].value < 0.005


def test_a_recording_knows_the_bodies_of_the_robot_and_how_near_its_joints_are_to_their_limits(
    cell: Cell, running: recorder.WorldRecorder
) -> None:
    cell.arm.move_by(z=-0.05)
    running.finish()
    assert set(running.recording.robots) == {"arm", "gripper"}
    margin = facts_of(RecordedPaths(running.recording))[MARGIN, "joint limit margin"]
    assert margin.unit == "deg"
    assert 0.0 < margin.value < 180.0
