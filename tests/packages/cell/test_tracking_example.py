"""The example ``tracking``: its own suite passes, and the shipped vocabulary is all it needs."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration

from .example_suites import EXAMPLES, run_suite

EXAMPLE = EXAMPLES / "tracking"


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_the_examples_own_suite_passes(project: Path) -> None:
    done = run_suite(project)
    assert done.returncode == 0, done.stdout


def test_it_needs_no_vocabulary_of_its_own(project: Path) -> None:
    assert load_configuration(project).vocabulary == ("cell",)
    assert not (project / "robot.toml").exists()
