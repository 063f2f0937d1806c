"""What presses, slips or hurries in a simulated cell breaks a monitor that the original keeps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest

from mutabot_cell import Box, Cell, Scene
from mutabot_suggest import tick_recorder
from mutabot_suggest.checks import Monitor
from mutabot_suggest.project import PlaceInTest
from mutabot_suggest.readings import Measured
from mutabot_suggest.suite import SuiteChecks
from mutabot_suggest.zones import monitors

PLACE = PlaceInTest("pytest", "tests/test_it.py", "tests/test_it.py::test_it", ("cell",))
USUAL = {"grip": 80.0, "speed": 0.5, "depth": 0.0}


class NoFiles:
    """A suite that has no files."""

    suite_files: tuple[str, ...] = ()


def carry(cell: Cell, grip: float, speed: float, depth: float) -> None:
    """Carry a slippery box with these fingers (N), speed (share) and depth below the usual height (m)."""
    box = cell.sensors.box_position()
    high = replace(cell.arm.commanded_pose(), theta_x=180, theta_y=0, x=box.x, y=box.y, z=0.275)
    low, y = box.z - 0.9 + 0.025, box.y - 0.1
    cell.gripper.set_force(grip)
    cell.arm.move_to(high, speed=speed)
    cell.arm.move_to(replace(high, z=low - depth), speed=speed)
    cell.gripper.command(1, wait=True)
    for pose in (high, replace(high, y=y), replace(high, y=y, z=low + 0.003)):
        cell.arm.move_to(pose, speed=speed)
    cell.gripper.command(0, wait=True)
    cell.arm.move_to(replace(high, y=y), speed=speed)


def run(seed: int, check: Monitor | None = None, **changed: float) -> dict[str, Any]:
    """Carry the box in a cell that is recorded, or has the monitor; raises ConditionBroken if it breaks."""
    with Cell(seed, scene=Scene(parts=(Box(mass=0.4, friction=0.06),))) as cell:
        if check is None:
            tick_recorder.watch("cell", cell)
        else:
            condition = check.condition
            cell.always(lambda: eval(condition, {"cell": cell}), check.name)
        carry(cell, **{**USUAL, **changed})
    return tick_recorder.recordings()


@pytest.fixture(scope="module")
def originals() -> Mapping[tuple[int, str], Any]:
    return {(seed, PLACE.node): run(seed) for seed in (1, 2)}


@pytest.mark.parametrize(
    ("changed", "name"),
    [
        ({"depth": 0.006}, "force on the tool stays below "),
        ({"grip": 33.0}, "box stays in its place between the fingers"),
        ({"speed": 1.0}, "tool speed stays below "),
    ],
)
def test_the_original_keeps_and_the_mutant_breaks_a_monitor_of_its_physics(
    originals: Mapping[tuple[int, str], Any], changed: dict[str, float], name: str
) -> None:
    measured = Measured(
        originals={PLACE: originals},
        mutants={PLACE: {"mutant": {(1, PLACE.node): run(1, **changed)}}},
        readings={PLACE: []},
    )
    project: Any = NoFiles()
    (check, *_) = [
        monitor for monitor in monitors(SuiteChecks(project), measured) if monitor.name.startswith(name)
    ]
    run(3, check)
    with pytest.raises(AssertionError, match=check.name):
        run(1, check, **changed)
