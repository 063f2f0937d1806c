"""The example ``dispensing``: its own suites pass, and each of the three asks more than the one before."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration

EXAMPLE = Path(__file__).parents[3] / "examples" / "dispensing"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the example."""
    copy = tmp_path / "dispensing"
    shutil.copytree(EXAMPLE, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
    return copy


def run_suite(project: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the example's tests on its program as it stands in the copy."""
    return subprocess.run(
        [sys.executable, "-B", "-m", "pytest", "-q", "-p", "no:cacheprovider", *words],
        cwd=project,
        env=os.environ | {"MUTABOT_SEED": "7"},
        capture_output=True,
        text=True,
        check=False,
    )


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
    program = project / "sealing.py"
    text = program.read_text(encoding="utf-8")
    assert text.count(before) == 1
    program.write_text(text.replace(before, after), encoding="utf-8")
    failed = [name for name in ("weak", "medium", "strong") if run_suite(project, f"tests/{name}").returncode]
    assert tuple(failed) == noticed


def test_its_equipment_has_a_vocabulary_beside_the_cells() -> None:
    assert load_configuration(EXAMPLE).vocabulary == ("cell", "station.toml")
