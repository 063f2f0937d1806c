"""A control that ends wrongly is tried again in a fresh process, and says where it hung."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.errors import ControlError
from tests.campaign.project import CONFIGURATION, Quiet, request_for, write_project
from tests.campaign.scripted import Died, Script

#: hangs in what is neither the baseline nor a fork parent: these are copies of the process that imported it
MISSION = """
    import os
    import time

    IMPORTED_BY = os.getpid()

    def get_stuck():
        time.sleep(3600)

    def run(arm):
        arm.move_by(0.5)
        if os.getppid() != IMPORTED_BY:
            get_stuck()
"""
TESTS = """
    import mission
    from robot import Arm

    def test_moves():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.5
"""


def project(folder: Path, mission: str) -> None:
    write_project(folder, mission, TESTS, configuration=CONFIGURATION + "    timeout_seconds = 2\n")


@pytest.mark.parametrize("engine", ["replay", "fork"])
def test_a_control_that_hangs_once_does_not_end_the_campaign(
    tmp_path: Path, script: Script, engine: str
) -> None:
    hangs = Died(overdue="no end after 2 s of wall clock")
    script.control = lambda run: None if run.before else hangs
    project(tmp_path, MISSION)
    progress = Quiet()
    run_campaign(request_for(tmp_path, engine=engine, only=("*:reverse",)), progress)
    lines = [line for line in progress.lines if "ended wrongly once" in line]
    assert {line.partition(" (")[0] for line in lines} == {
        "the identity control of tests/test_mission.py ended wrongly once",
        "the fatal control of tests/test_mission.py ended wrongly once",
    }
    assert all("no end after 2 s of wall clock" in line for line in lines)


def test_a_control_that_hangs_twice_ends_the_campaign(tmp_path: Path) -> None:
    project(tmp_path, MISSION)
    with pytest.raises(ControlError, match="no verdict of this campaign could be believed") as caught:
        run_campaign(request_for(tmp_path, engine="fork", only=("*:reverse",)), Quiet())
    assert "no end after 2 s of wall clock" in str(caught.value)
