"""The example ``dispensing``: its own suites pass, and each of the three asks more than the one before."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration

from .example_suites import EXAMPLES, noticing, run_suite

EXAMPLE = EXAMPLES / "dispensing"


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_the_examples_own_suite_passes(project: Path) -> None:
    done = run_suite(project)
    assert done.returncode == 0, done.stdout


#: an edit of the program by hand, and the suites that notice it
EDITS = {
    "the bead is laid twice as fast": ("SPEED = 0.06", "SPEED = 0.12", ("medium", "strong")),
    "the bead lies 1 mm beside its groove": ("self.x + across", "self.x + 0.001 + across", ("strong",)),
    "the valve is never opened": ("    dispenser.open()\n", "", ("weak", "medium", "strong")),
    "the nozzle stands 1 mm too high": ("STANDOFF = 0.002", "STANDOFF = 0.003", ("strong",)),
}


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize("edit", EDITS)
def test_the_stronger_suites_notice_what_the_weaker_ones_let_through(project: Path, edit: str) -> None:
    before, after, noticed = EDITS[edit]
    assert noticing(project, "sealing.py", before, after) == noticed


def test_its_equipment_has_a_vocabulary_beside_the_cells() -> None:
    assert load_configuration(EXAMPLE).vocabulary == ("cell", "station.toml")
