"""The example ``bin_picking``: its own suites pass, and each of the three asks more than the one before."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary.load import load_vocabulary

EXAMPLE = Path(__file__).parents[3] / "examples" / "bin_picking"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the example."""
    copy = tmp_path / "bin_picking"
    shutil.copytree(EXAMPLE, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
    return copy


def run_suite(project: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the example's tests on its program as it stands in the copy."""
    return subprocess.run(
        [sys.executable, "-B", "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *words],
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
    "the ejector is never started": ("    cell.suction.on()\n", "", ("weak", "medium", "strong")),
    "plates and cubes go into each other's tray": (
        '"plate": (0.45, -0.36), "cube": (0.21, -0.36)', '"plate": (0.21, -0.36), "cube": (0.45, -0.36)',
        ("medium", "strong"),
    ),
    "the robot does not go home": ("    cell.arm.home()\n", "", ("strong",)),
}  # fmt: skip


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize("edit", EDITS)
def test_the_stronger_suites_notice_what_the_weaker_ones_let_through(project: Path, edit: str) -> None:
    before, after, noticed = EDITS[edit]
    program = project / "picking.py"
    text = program.read_text(encoding="utf-8")
    assert text.count(before) == 1
    program.write_text(text.replace(before, after), encoding="utf-8")
    failed = [name for name in ("weak", "medium", "strong") if run_suite(project, f"tests/{name}").returncode]
    assert tuple(failed) == noticed


def test_what_its_vision_finds_has_a_vocabulary_beside_the_cells() -> None:
    configuration = load_configuration(EXAMPLE)
    found = load_vocabulary(configuration.vocabulary, configuration.root)
    assert {"vision:locate", "mutabot_cell.depth_camera:StereoCamera.picture"} <= {
        operation.target for operation in found.operations
    }
