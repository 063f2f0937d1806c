"""The example ``ros2``: its own suite, and the end of a few of the published mutants in its nodes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from campaign.project import run
from mutabot.model import Verdict
from ros2_domain import domain

from .both import needs_ros2

pytestmark = needs_ros2

EXAMPLE = Path(__file__).parents[3] / "examples" / "ros2"

#: verdict, with the reason why it must be this one
EXPECTED = {
    # The fingers stay open, so the box stays on the conveyor.
    "mission.py:run:gripper.command#2:call:skip": Verdict.KILLED,
    # Closing closed fingers does nothing more.
    "mission.py:run:gripper.command#2:call:repeat": Verdict.SURVIVED,
    # 0.29 m up instead of down is beyond the arm's reach: the driver refuses it.
    "mission.py:run:arm.move_by#3:linear.z:reverse": Verdict.REFUSED,
    # On the other side it may move, but cannot make its next move: that one's refusal is a failure.
    "mission.py:run:arm.move_by#4:angular.z:reverse": Verdict.KILLED,
}


@pytest.fixture
def example(tmp_path: Path) -> Path:
    """A copy of the example."""
    folder = tmp_path / "ros2"
    shutil.copytree(
        EXAMPLE, folder, ignore=shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache")
    )
    return folder


def run_suite(folder: Path, number: int, seed: int) -> subprocess.CompletedProcess[str]:
    """Plain pytest on the example, which has the patience that a busy machine needs."""
    for name in ("kinova.py", "tracker.py"):
        text = (folder / name).read_text()
        (folder / name).write_text(text.replace("PATIENCE = 10.0", "PATIENCE = 60.0"))
    environment = {**os.environ, "ROS_DOMAIN_ID": str(number), "MUTABOT_SEED": str(seed)}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300, check=False
    )


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_the_program_passes_its_test_for_both_colours(example: Path) -> None:
    with domain() as number:
        for seed in (0, 2):
            done = run_suite(example, number, seed)
            assert done.returncode == 0, done.stdout


@pytest.mark.usefixtures("plugins")
def test_a_move_in_the_wrong_direction_is_noticed(example: Path) -> None:
    mission = example / "mission.py"
    mission.write_text(mission.read_text().replace("arm.move_by(y=0.2)", "arm.move_by(y=-0.2)"))
    with domain() as number:
        done = run_suite(example, number, 0)
    assert done.returncode == 1, done.stdout
    assert "1 failed" in done.stdout


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_mutants_in_the_mission_node_end_as_they_must(example: Path) -> None:
    found = run(example, rounds=1, baseline=1, only=tuple(EXPECTED), engine="replay")
    assert {mutant: outcome.verdict for mutant, outcome in found.items()} == EXPECTED, found
