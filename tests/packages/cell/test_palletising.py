"""The example ``palletising``: its own suite passes, and the shipped vocabulary is all it needs."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration

EXAMPLE = Path(__file__).parents[3] / "examples" / "palletising"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the example."""
    copy = tmp_path / "palletising"
    shutil.copytree(EXAMPLE, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
    return copy


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_the_examples_own_suite_passes(project: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-B", "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=project,
        env=os.environ | {"MUTABOT_SEED": "7"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


def test_it_needs_no_vocabulary_of_its_own(project: Path) -> None:
    assert load_configuration(project).vocabulary == ("cell",)
    assert not (project / "robot.toml").exists()
