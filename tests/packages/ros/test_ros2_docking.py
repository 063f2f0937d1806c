"""The example ``ros2_docking``: its own suite, and what it notices."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from ros2_domain import domain

from .docking_races import RACES, Race

EXAMPLE = Path(__file__).parents[3] / "examples" / "ros2_docking"
needs_ros = pytest.mark.skipif(
    find_spec("rclpy") is None, reason="no ROS 2: pip install -r requirements-ros2.lock"
)


@pytest.fixture
def example(tmp_path: Path) -> Path:
    """A copy of the example."""
    folder = tmp_path / "ros2_docking"
    shutil.copytree(
        EXAMPLE, folder, ignore=shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache")
    )
    return folder


def run_suite(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Plain pytest on the example."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments]
    with domain() as number:
        environment = {**os.environ, "ROS_DOMAIN_ID": str(number)}
        return subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120, check=False
        )


@needs_ros
@pytest.mark.whole
def test_the_program_passes_its_tests(example: Path) -> None:
    done = run_suite(example)
    assert done.returncode == 0, done.stdout


@needs_ros
def test_a_robot_that_drives_the_wrong_way_is_noticed(example: Path) -> None:
    program = example / "docking.py"
    text = program.read_text()
    program.write_text(text.replace("linear=Vector3(x=forward)", "linear=Vector3(x=-forward)"))
    done = run_suite(example, "tests/test_docking.py::test_it_stands_still_when_it_is_told_to_and_can_go_on")
    assert done.returncode == 1, done.stdout
    assert "1 failed" in done.stdout


@pytest.mark.parametrize("race", RACES.values(), ids=RACES)
def test_a_race_is_one_edit_of_the_program(race: Race) -> None:
    text = (EXAMPLE / "docking.py").read_text()
    assert text.count(race.before) == 1
    compile(text.replace(race.before, race.after), "docking.py", "exec")
