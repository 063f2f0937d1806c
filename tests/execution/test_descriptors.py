"""Open files: the limit is raised where it is too low, or the campaign is refused before anything runs."""

from __future__ import annotations

import re
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.errors import ExitCode
from mutabot.execution.processes import needed
from tests.campaign.project import REPLAY, write_project

MISSION = "def run(arm):\n    arm.move_by(0.25)\n"
TESTS = """
    from pathlib import Path

    import mission
    from robot import Arm

    Path(__file__).with_name("was_run").touch()

    def test_run():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.25
"""


def command(folder: Path, soft: int, hard: int, *words: str) -> tuple[int, str]:
    """Exit code and errors of a command that may have so many files open."""
    write_project(folder, MISSION, TESTS)
    done = subprocess.run(
        [sys.executable, "-m", "mutabot", "-C", str(folder), *words],
        capture_output=True, text=True, check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard)),
    )  # fmt: skip
    return done.returncode, done.stderr


SLOW = [pytest.param((name, "-j", "2"), marks=pytest.mark.whole) for name in ("check", "list")]


@pytest.mark.parametrize("words", [("run", "-j", "2"), *SLOW])
def test_too_few_are_refused_before_anything_runs(tmp_path: Path, words: tuple[str, ...]) -> None:
    code, err = command(tmp_path, 24, 24, *words)
    assert code == ExitCode.USAGE
    assert f"-j 2 needs {needed(2)} open files at a time, but the system allows 24" in err
    assert not (tmp_path / "tests" / "was_run").exists()
    assert not (tmp_path / ".mutabot" / "crash.txt").exists()


@pytest.mark.whole
def test_fewer_jobs_are_advised_where_they_would_do(tmp_path: Path) -> None:
    most = needed(3) + 1
    code, err = command(tmp_path, 24, most, "run", "-j", "500")
    assert code == ExitCode.USAGE
    advised = re.search(r"or use -j (\d+)", err)
    assert advised is not None
    assert advised[1] == "3"
    assert command(tmp_path, 24, most, "list", "-j", advised[1])[0] == ExitCode.FINE


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_a_low_limit_is_raised_as_far_as_it_may_be_and_that_is_enough(tmp_path: Path, engine: str) -> None:
    code, err = command(tmp_path, 24, needed(2), "run", "-j", "2", "--engine", engine)
    assert code == ExitCode.FINE, err
