"""The example ``pick_and_place``: its own suite passes, and the shipped vocabulary fits its program."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary

EXAMPLE = Path(__file__).parents[3] / "examples" / "pick_and_place"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the example."""
    copy = tmp_path / "pick_and_place"
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


def test_the_shipped_vocabulary_of_the_cell_loads(project: Path) -> None:
    configuration = load_configuration(project)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    assert configuration.vocabulary == ("cell",)
    assert vocabulary.operations
    assert vocabulary.clock is not None
    assert vocabulary.probes


def test_every_name_in_the_shipped_vocabulary_exists() -> None:
    vocabulary = load_vocabulary(["cell"], EXAMPLE)
    targets = [operation.target for operation in vocabulary.operations]
    targets += [*vocabulary.refusals, *vocabulary.checks, *vocabulary.failures]
    targets += [probe.target for probe in vocabulary.probes]
    assert vocabulary.clock is not None
    for target in [*targets, vocabulary.clock.tick]:
        module, _, name = target.partition(":")
        found: object = __import__(module, fromlist=["_"])
        for part in name.split("."):
            found = getattr(found, part)
        assert found is not None
