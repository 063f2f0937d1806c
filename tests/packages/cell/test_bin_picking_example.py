"""The example ``bin_picking``: its own suites pass, and each of the three asks more than the one before."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary.load import load_vocabulary

from .example_suites import EXAMPLES, noticing, run_suite

EXAMPLE = EXAMPLES / "bin_picking"


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_the_examples_own_suite_passes(project: Path) -> None:
    done = run_suite(project)
    assert done.returncode == 0, done.stdout


#: an edit of the program by hand, and the suites that notice it
EDITS = {
    "the ejector is never started": ("    cell.suction.on()\n", "", ("weak", "medium", "strong")),
    "plates and cubes go into each other's tray": (
        "TRAYS[shape]", 'TRAYS[{"plate": "cube", "cube": "plate"}.get(shape, shape)]', ("medium", "strong"),
    ),
    "the robot does not go home": ("    cell.arm.home()\n", "", ("strong",)),
}  # fmt: skip


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize("edit", EDITS)
def test_the_stronger_suites_notice_what_the_weaker_ones_let_through(project: Path, edit: str) -> None:
    before, after, noticed = EDITS[edit]
    assert noticing(project, "picking.py", before, after) == noticed


def test_what_its_vision_finds_has_a_vocabulary_beside_the_cells() -> None:
    configuration = load_configuration(EXAMPLE)
    found = load_vocabulary(configuration.vocabulary, configuration.root)
    assert {"vision:locate", "mutabot_cell.depth_camera:StereoCamera.picture"} <= {
        operation.target for operation in found.operations
    }
