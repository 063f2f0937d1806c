"""The example ``assembly``: its forces are those of a hand calculation, its suites ask ever more."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary.load import load_vocabulary

from .example_suites import EXAMPLES, noticing, run_suite

EXAMPLE = EXAMPLES / "assembly"


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_the_examples_own_suite_passes(project: Path) -> None:
    done = run_suite(project)
    assert done.returncode == 0, done.stdout


#: an edit of the program by hand, and the suites that notice it
EDITS = {
    "the pin is not gripped": ("cell.gripper.command(1, wait=True)", "pass", ("weak", "medium", "strong")),
    "the search is too short": ("RINGS = 0.0006, 3", "RINGS = 0.0006, 0", ("weak", "medium", "strong")),
    "the screw is too loose": ("TIGHT = 1.6", "TIGHT = 1.3", ("medium", "strong")),
    "the last turn is fast": ("SCREW_SLOW = 12.0, 1.5", "SCREW_SLOW = 12.0, 60.0", ("strong",)),
}  # fmt: skip


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize("edit", EDITS)
def test_the_stronger_suites_notice_what_the_weaker_ones_let_through(project: Path, edit: str) -> None:
    before, after, noticed = EDITS[edit]
    assert noticing(project, "assembling.py", before, after) == noticed


_SLIDING = """
import json

import assembling
from assembling import HOLE_X, HOLE_Y, HOVER, down
from mutabot_cell import Cell
from station import build

station = build(lambda seed, **options: Cell(seed, noise=False, **options), 3, off=(0.0, 0.0))
cell, forces = station.cell, []
cell.arm.move_joints(assembling.DOWN)
assembling.fetch(cell)
cell.arm.move_to(down(HOLE_X, HOLE_Y, HOVER))
cell.wait(0.3)
cell.force_sensor.zero()
cell.arm.move_until_contact(z=-0.010, force=4.0, speed=0.02)  # 5 mm into the hole

def note():
    wrench = cell.force_sensor.wrench()
    forces.append((wrench.fx, wrench.fy, wrench.fz, cell.truth.box_position("pin").z))
    return True

cell.always(note, "forces are noted")
cell.arm.push(x=8.0, y=0.0, z=-8.0, seconds=5.0, travel=0.012, speed=0.01)
print(json.dumps(forces))
"""


@pytest.mark.whole
def test_a_pin_that_is_pushed_against_the_holes_side_resists_with_the_friction_of_that_force() -> None:
    """By hand: F = μ·N, with 0.4 for steel; both as the wrist's sensor reads them while the pin slides in."""
    done = subprocess.run(
        [sys.executable, "-B", "-c", _SLIDING], cwd=EXAMPLE, capture_output=True, text=True, check=True
    )
    across, along, axial, height = np.array(json.loads(done.stdout)).T
    slides = np.abs(np.gradient(height)) > 2e-6
    slides &= np.arange(len(height)) > 100
    pressed = np.hypot(across, along)[slides]
    assert slides.sum() > 50
    assert pressed.mean() > 5.0
    assert np.abs(axial[slides]).mean() == pytest.approx(0.4 * pressed.mean(), rel=0.2)


def test_its_equipment_has_a_vocabulary_beside_the_cells() -> None:
    configuration = load_configuration(EXAMPLE)
    found = load_vocabulary(configuration.vocabulary, configuration.root)
    assert {"station:Spindle.torque", "mutabot_cell.arm:Arm.push"} <= {
        operation.target for operation in found.operations
    }
