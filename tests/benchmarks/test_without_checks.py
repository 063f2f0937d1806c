"""The plug-in that switches the checks of tests off."""

from __future__ import annotations

from pathlib import Path

import pytest

from comparison.run import switched_off
from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.model import By, Outcome, Verdict
from tests.campaign.project import Quiet, outcomes, request_for, write_project

CONFIGURATION = """
program = ["mission.py"]
vocabulary = ["robot.toml"]
pytest_args = ["-o", "pythonpath=. tests"]
"""


def ends(request: Request) -> dict[str, Outcome]:
    return {outcome.mutant: outcome for outcome in outcomes(run_campaign(request, Quiet()))}


@pytest.mark.whole
def test_without_checks_only_exceptions_kill(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mission = "def near(x):\n    assert x >= 0\n    return 1 / (x - 0.5) < 0\n"
    tests = """
        import unittest
        import helper
        import mission
        import pytest

        def test_near():
            assert mission.near(0.1)
            helper.check(mission.near(0.2))

        class TestFar(unittest.TestCase):
            def test_far(self):
                self.assertFalse(mission.near(0.9))
                self.assertRaises(AssertionError, mission.near, -1.0)

        def test_fails():
            if not mission.near(0.3):
                pytest.fail("it is far")
    """
    helper = {"tests/helper.py": "def check(value):\n    assert value\n", "tests/conftest.py": ""}
    project = write_project(tmp_path, mission, tests, configuration=CONFIGURATION, more=helper)
    inverted = "mission.py:near:1 / (x - 0.5) < 0#1:UOI=not"
    program = "mission.py:near:x >= 0#1:UOI=not"  # an assertion of the program is none of the tests'
    bomb = "mission.py:near:return 1 / (x - 0.5) < 0#1:BSR"
    wanted = {
        "engine": "auto",
        "families": ("conventional",),
        "only": (inverted, program, bomb),
        "fresh": True,
    }
    checked = ends(request_for(project, **wanted))
    request, variables = switched_off(request_for(project, **wanted))
    with monkeypatch.context() as patch:
        for name, value in variables.items():
            patch.setenv(name, value)
        unchecked = ends(request)
    assert checked.keys() == unchecked.keys()
    assert not [mutant for mutant, outcome in unchecked.items() if outcome.by is By.CHECK]
    assert (checked[inverted].by, unchecked[inverted].verdict) == (By.CHECK, Verdict.SURVIVED)
    assert (unchecked[program].verdict, unchecked[program].by) == (Verdict.KILLED, By.EXCEPTION)
    assert unchecked[bomb].verdict is Verdict.KILLED
