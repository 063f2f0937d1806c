"""What follows the last test belongs to it: hooks and exit handlers make calls, and decide the exit code."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import REPLAY, run, write_project

MISSION = """
    def go(arm):
        arm.move_by(0.5)

    def back(arm):
        arm.move_by(-0.5)
"""
TESTS = """
    import mission

    def test_go(arm):
        mission.go(arm)
        assert arm.x < 1.5
"""
CONFTEST = """
    import atexit
    import os
    import mission
    import pytest
    from robot import Arm

    ARM = Arm()

    @pytest.fixture
    def arm():
        return ARM
"""
ENDS = {
    "a hook sets the exit status": """
    def pytest_sessionfinish(session):
        mission.back(ARM)
        session.exitstatus = 9 if ARM.x else 0
""",
    "a hook leaves at once": """
    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish():
        mission.back(ARM)
        os._exit(ARM.x != 0.0)
""",
    "a hook raises": """
    def pytest_unconfigure():
        mission.back(ARM)
        assert ARM.x == 0.0
""",
    "an exit handler": """
    @atexit.register
    def park():
        mission.back(ARM)
        if ARM.x:
            os._exit(3)
""",
    "nothing looks": """
    @atexit.register
    def park():
        mission.back(ARM)
""",
}


@pytest.mark.parametrize("engine", ["fork", REPLAY])
@pytest.mark.parametrize("end", ENDS)
def test_mutants_of_calls_after_the_last_test_are_judged_by_the_exit_code(
    tmp_path: Path, end: str, engine: str
) -> None:
    write_project(tmp_path, MISSION, TESTS, more={"conftest.py": CONFTEST + ENDS[end]})
    expected = Verdict.SURVIVED if end == "nothing looks" else Verdict.KILLED
    found = run(tmp_path, engine=engine, only=("*back*:repeat",))
    assert [outcome.verdict for outcome in found.values()] == [expected]
