"""The example ``ros1``: its own suite, and the end of a few of the published mutants in its nodes."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from campaign.project import run
from mutabot.model import Verdict

from .both import needs_ros1

EXAMPLE = Path(__file__).parents[3] / "examples" / "ros1"
pytestmark = needs_ros1

#: verdict, with the reason why it must be this one
EXPECTED = {
    # The fingers stay open, so the box stays on the conveyor.
    "mission.py:run:gripper.close#2:call:skip": Verdict.KILLED,
    # Closing closed fingers does nothing more.
    "mission.py:run:gripper.close#2:call:repeat": Verdict.SURVIVED,
    # 0.29 m up instead of down is beyond the arm's reach: the driver rejects it.
    "mission.py:run:arm.move_by#3:twist.linear.z:reverse": Verdict.REFUSED,
}


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the example."""
    copy = tmp_path_factory.mktemp("ros1") / "ros1"
    shutil.copytree(EXAMPLE, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
    return copy


@pytest.mark.usefixtures("plugins")
def test_the_examples_own_suite_passes_with_a_master_of_its_own(project: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-B", "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=project,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


def test_mutants_in_the_mission_node_end_as_they_must(project: Path) -> None:
    found = run(project, rounds=1, baseline=1, only=tuple(EXPECTED))
    assert {mutant: outcome.verdict for mutant, outcome in found.items()} == EXPECTED


@pytest.mark.whole
def test_a_mission_in_the_tests_own_process_ends_alike(project: Path, tmp_path: Path) -> None:
    copy = tmp_path / "here"
    shutil.copytree(project, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
    tests = copy / "tests" / "test_mission.py"
    before, began, rest = tests.read_text(encoding="utf-8").partition("    mission = subprocess.run(")
    _, ended, after = rest.partition("assert mission.returncode == 0\n")
    assert began
    assert ended
    imported = before.replace("from expected", "import kinova\nimport mission\nfrom expected")
    tests.write_text(f"{imported}    kinova.connect()\n    mission.run()\n{after}", encoding="utf-8")
    mutant = "mission.py:run:gripper.close#2:call:skip"
    found = run(copy, rounds=1, baseline=1, only=(mutant,))
    assert found[mutant].verdict is EXPECTED[mutant]
