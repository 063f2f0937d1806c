"""A control that ends wrongly is tried again in a fresh process, and says where it hung."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.errors import BaselineError, ControlError
from mutabot.execution.task import Task
from mutabot.model import process_time
from tests.campaign.project import CONFIGURATION, Quiet, request_for, write_project
from tests.campaign.scripted import Died, Script

#: hangs in what is neither the baseline nor a trunk: these are copies of the process that imported it
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


def where() -> str:
    lines = MISSION.splitlines()
    sleeps, stuck = (
        next(n for n, line in enumerate(lines, 1) if text in line) for text in (".sleep", "  get_stuck()")
    )
    called = f"called from mission.py:{stuck} run, called from tests/test_mission.py:7 test_moves"
    return f"it was at mission.py:{sleeps} get_stuck, {called}"


def project(folder: Path, mission: str) -> None:
    write_project(folder, mission, TESTS, configuration=CONFIGURATION + "    timeout_seconds = 2\n")


@pytest.mark.parametrize("engine", ["replay", "branch"])
def test_a_control_that_hangs_once_does_not_end_the_campaign(
    tmp_path: Path, script: Script, engine: str
) -> None:
    hangs = Died(overdue="no end after 2 s of wall clock", where=where())
    script.control = lambda run: None if run.before else hangs
    project(tmp_path, MISSION)
    progress = Quiet()
    run_campaign(request_for(tmp_path, engine=engine, only=("*:reverse",)), progress)
    lines = [line for line in progress.lines if "ended wrongly once" in line]
    assert {line.partition(" (")[0] for line in lines} == {
        "the identity control of tests/test_mission.py ended wrongly once",
        "the fatal control of tests/test_mission.py ended wrongly once",
    }
    assert all(where() in line for line in lines)


def test_a_control_that_hangs_twice_ends_the_campaign_and_says_where(tmp_path: Path) -> None:
    project(tmp_path, MISSION)
    with pytest.raises(ControlError, match="no verdict of this campaign could be believed") as caught:
        run_campaign(request_for(tmp_path, engine="branch", only=("*:reverse",)), Quiet())
    assert where() in str(caught.value)


def test_the_calls_of_a_stack_are_told_innermost_first_without_those_of_the_test_runner() -> None:
    text = """Thread 0x00007f0000000001 (most recent call first):
  File "/usr/lib/python3.11/threading.py", line 320 in wait

Current thread 0x00007f0000000002 (most recent call first):
  File "/home/me/cell/robot.py", line 7 in wait
  File "/usr/lib/python3.11/contextlib.py", line 81 in inner
  File "/home/me/cell/tests/test_a.py", line 3 in test_it
  File "/venv/site-packages/_pytest/python.py", line 159 in pytest_pyfunc_call
  File "/venv/site-packages/pluggy/_callers.py", line 121 in _multicall
"""
    assert process_time.calls_in_words(text, "/home/me/cell") == (
        "robot.py:7 wait, called from contextlib.py:81 inner, called from tests/test_a.py:3 test_it"
    )
    assert process_time.calls_in_words("", "/home/me/cell") is None


def test_a_baseline_that_hangs_says_where(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mission = "import time\n\ndef run(arm):\n    arm.move_by(0.5)\n    time.sleep(3600)\n"
    write_project(tmp_path, mission, TESTS)
    monkeypatch.setattr("mutabot.campaign.baseline.taking.Task", partial(Task, deadline=2.0))
    with pytest.raises(
        BaselineError, match=r"it was at mission\.py:5 run, called from tests/test_mission\.py"
    ):
        run_campaign(request_for(tmp_path), Quiet())
