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
    "the search is too short": ("RINGS = 0.0006, 3", "RINGS = 0.0006, 0", ("weak", "medium", "strong")),
    "the screws are too loose": ("TIGHT = 1.6", "TIGHT = 1.3", ("medium", "strong")),
    "the last turn is fast": ("SLOW = 15.0, 1.5", "SLOW = 15.0, 60.0", ("strong",)),
    "a pin that does not fit is dropped from high": ("0.190, 0.16, 0.17", "0.190, 0.16, 0.34", ("strong",)),
    "a clamp that does not close is no matter": ("if not station.clamp.is_closed()", "if False", ("strong",)),
    "the screws are not tightened crosswise": (
        "(0.068, 0.018), (0.068, -0.018)", "(0.068, -0.018), (0.068, 0.018)", ("strong",)
    ),
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
from assembling import HOLE, HOVER, PIN, PIN_GRIP, PIN_Z, down
from mutabot_cell import Cell
from station import build

station = build(lambda seed, **options: Cell(seed, noise=False, **options), 3, off=(0.0, 0.0))
cell, forces = station.cell, []
cell.arm.move_joints(assembling.DOWN)
assembling.fetch(cell, PIN, PIN_Z, PIN_GRIP, "no pin")
cell.arm.move_to(down(*HOLE, HOVER))
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


_HOLDING = """
import json
import math
import sys

import assembling
from mutabot_cell import Cell
from station import build

station = build(lambda seed, **options: Cell(seed, noise=False, **options), 3)
cell, data, screwdriver = station.cell, station.cell.simulation.data, "driver"
assembling.DRIVER_GRIP = float(sys.argv[1])
cell.arm.move_joints(assembling.DOWN)
assembling.take_screwdriver(station)
cell.wait(0.5)
before, torque, turned, seen = cell.force_sensor.wrench().tz, 0.0, 0.0, []
while turned < 1.0:
    seen.append((torque, before - cell.force_sensor.wrench().tz))
    torque += 0.0002 * assembling.DRIVER_GRIP
    data.xfrc_applied[cell.simulation.id_of("body", screwdriver)] = (0, 0, 0, 0, 0, torque)
    cell.wait(0.01)
    quaternion = data.body(screwdriver).xquat
    turned = math.degrees(2 * math.atan2(abs(quaternion[3]), abs(quaternion[0])))
print(json.dumps(seen))
"""


@pytest.mark.whole
@pytest.mark.parametrize("grip", [20.0, 60.0])
def test_a_screwdriver_turns_in_the_gripper_at_the_torque_that_grip_and_friction_hold(grip: float) -> None:
    """By hand: M = F·(w + μ·b) for pads w = 22 mm wide around a handle of b = 24 mm: turning it presses the
    pads apart at opposite edges, where they rub. Until then the wrist feels all of the torque.
    """
    done = subprocess.run(
        [sys.executable, "-B", "-c", _HOLDING, str(grip)],
        cwd=EXAMPLE,
        capture_output=True,
        text=True,
        check=True,
    )
    torque, felt = np.array(json.loads(done.stdout)).T
    assert torque[-1] == pytest.approx(grip * (0.022 + 0.7 * 0.024), rel=0.06)
    half = len(torque) // 2
    assert felt[10:half] == pytest.approx(torque[10:half], rel=0.05)


_TIGHTENING = """
import json

import assembling
from mutabot_cell import Cell
from station import build

station = build(lambda seed, **options: Cell(seed, noise=False, **options), 3)
cell, seen = station.cell, []

def note():
    if station.driver.is_turning:
        number, wrench = station.driver.screw_below(), cell.truth.wrench()
        screw = station.driver.screws[number]
        seen.append((number, screw.angle - screw.seats, screw.torque(), wrench.tz))
    return True

cell.always(note, "torques are noted")
assembling.run(station)
print(json.dumps(seen))
"""


@pytest.mark.whole
def test_a_screw_runs_down_freely_then_its_torque_rises_with_the_angle_and_the_wrist_bears_it() -> None:
    """By hand: 0.1 Nm, and 2 Nm more for each radian after the head rests. The nose on the cover takes at
    most 0.4 · 20 N at its corners, 17 mm from the middle: 0.14 Nm.
    """
    done = subprocess.run(
        [sys.executable, "-B", "-c", _TIGHTENING], cwd=EXAMPLE, capture_output=True, text=True, check=True
    )
    number, beyond, torque, felt = np.array(json.loads(done.stdout)).T
    assert set(number) == {0, 1, 2, 3}
    for screw in range(4):
        own = number == screw
        assert beyond[own].max() == pytest.approx((1.6 - 0.1) / 2, abs=0.06)
        assert torque[own].max() == pytest.approx(1.6, abs=0.12)
        rise = torque[own].argmax() - (beyond[own] < 0).sum()
        assert rise > 10
        change = felt[own][0] - felt[own][torque[own].argmax()]
        assert change == pytest.approx(1.6 - 0.1, abs=0.14 + 0.12)


def test_its_equipment_has_a_vocabulary_beside_the_cells() -> None:
    configuration = load_configuration(EXAMPLE)
    found = load_vocabulary(configuration.vocabulary, configuration.root)
    assert {"screwdriver:Screwdriver.torque", "mutabot_cell.arm:Arm.start_push"} <= {
        operation.target for operation in found.operations
    }
