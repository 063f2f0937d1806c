"""A suite that a verdict ends early ends as pytest's ``-x`` ends it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import Verdict
from tests.campaign.project import Quiet, outcomes, request_for, write_project

MISSION = """
    def go(arm):
        arm.move_by(0.25)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_goes():
        arm = Arm()
        mission.go(arm)
        assert arm.x == 0.25

    def test_comes_later():
        pass
"""
HOOKS = """
    def note(text, file={file!r}):
        with open(file, "a") as opened:
            print(text, file=opened)

    def pytest_keyboard_interrupt():
        note("interrupted")

    def pytest_sessionfinish(exitstatus):
        note(int(exitstatus))
"""


@pytest.fixture
def notes() -> Iterator[Path]:
    """A file that no run keeps to itself."""
    path = Path(f"/var/tmp/mutabot-early-end-{os.getpid()}")
    path.unlink(missing_ok=True)
    yield path
    path.unlink(missing_ok=True)


def test_a_suite_stops_after_a_kill_as_after_a_failure_and_not_as_if_interrupted(
    tmp_path: Path, notes: Path
) -> None:
    """To lay out the traceback of an interruption takes pytest longer than a short suite."""
    folder = write_project(tmp_path, MISSION, TESTS, more={"conftest.py": HOOKS.format(file=str(notes))})
    request = request_for(folder, engine="replay", rounds=1, only=("skip",))
    (found,) = outcomes(run_campaign(request, Quiet()))
    assert (found.verdict, found.tests) == (Verdict.KILLED, 1)
    told = notes.read_text().split()
    assert told.count("1") == 2  # the mutant, and the control that raises
    assert set(told) == {"0", "1"}
