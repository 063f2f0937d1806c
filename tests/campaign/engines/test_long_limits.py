"""Limits may add up to more than a system call can wait for, as those of a long suite do."""

from __future__ import annotations

from pathlib import Path

from mutabot.config import options
from mutabot.model import Verdict
from tests.campaign.project import CONFIGURATION, run, write_project

MISSION = """
    def go(arm):
        arm.move_by(0.25)
        return arm.position()
"""
TESTS = """
    import time

    import mission
    from robot import Arm

    def test_goes():
        time.sleep(1.0)  # longer than what is waited before limits are looked at
        assert mission.go(Arm()) == 0.25

    def test_goes_on():
        assert mission.go(Arm(0.5)) == 0.75
"""


def test_limits_of_weeks_are_waited_for(tmp_path: Path) -> None:
    limits = f"    timeout_seconds = {options.SECONDS}\n"
    folder = write_project(tmp_path, MISSION, TESTS, configuration=CONFIGURATION + limits)
    part = run(folder, engine="fork", only=("*:skip",))
    assert {outcome.verdict for outcome in part.values()} == {Verdict.KILLED}
    whole = run(folder, engine="fork")  # with the baseline that was kept
    assert len(whole) > len(part)
    assert {outcome.verdict for outcome in whole.values()} == {Verdict.KILLED}
