"""A mutant is judged by every test that can notice it, also through what tests share."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import By, Outcome, Verdict
from tests.campaign.project import Quiet, outcomes, request_for, write_project

#: kills, of the mutants below, what a suite that asserts all can kill
MISSION = """
    def run(arm):
        arm.move_by(0.75)
        return arm.position()
"""
#: two mutants: one that every suite below notices, and one of a reading that none looks at
SELECTED = ("*:dx:reverse", "*:negate")
SUITES = {
    "a module fixture": """
        import mission, pytest
        from robot import Arm

        @pytest.fixture(scope="module")
        def arm():
            arm = Arm()
            mission.run(arm)
            return arm

        def test_is_there(arm):
            assert arm is not None

        def test_arrives(arm):
            assert arm.x == 0.75
    """,
    "a plain value of a session fixture": """
        import mission, pytest
        from robot import Arm

        @pytest.fixture(scope="session")
        def x():
            arm = Arm()
            mission.run(arm)
            return arm.x

        def test_is_there(x):
            assert x is not None

        def test_arrives(x):
            assert x == 0.75
    """,
    "a fixture through a fixture": """
        import mission, pytest
        from robot import Arm

        @pytest.fixture(scope="module")
        def arm():
            return Arm()

        @pytest.fixture(scope="module", autouse=True)
        def done(arm):
            mission.run(arm)

        def test_is_there():
            pass

        def test_arrives(arm):
            assert arm.x == 0.75
    """,
    "a factory": """
        import mission, pytest
        from robot import Arm

        @pytest.fixture(scope="module")
        def make():
            arm = Arm()
            return lambda: arm

        def test_acts(make):
            mission.run(make())

        def test_arrives(make):
            assert make().x == 0.75
    """,
    "a simulator of the session, one acts and one checks": """
        import mission, pytest
        from robot import Arm

        @pytest.fixture(scope="session")
        def arm():
            return Arm()

        def test_acts(arm):
            mission.run(arm)

        def test_checks(arm):
            assert arm.x == 0.75
    """,
    "setUpClass": """
        import unittest
        import mission
        from robot import Arm

        class MissionTest(unittest.TestCase):
            @classmethod
            def setUpClass(cls):
                cls.arm = Arm()
                mission.run(cls.arm)

            def test_a(self):
                self.assertIsNotNone(self.arm)

            def test_b(self):
                self.assertEqual(self.arm.x, 0.75)
    """,
    "setup_module": """
        import mission
        from robot import Arm

        def setup_module(module):
            module.arm = Arm()
            mission.run(arm)

        def test_a():
            assert arm is not None

        def test_b():
            assert arm.x == 0.75
    """,
    "a simulator of the module": """
        import mission
        from robot import Arm

        ARM = Arm()

        def test_acts():
            mission.run(ARM)

        def test_arrives():
            assert ARM.x == 0.75
    """,
    "a simulator that the original puts back": """
        import mission
        from robot import Arm

        ARM = Arm()

        def test_acts():
            mission.run(ARM)
            if ARM.x > 0:
                ARM.move_by(-0.75)

        def test_is_back():
            assert ARM.x == 0
    """,
    "a simulator in a cache": """
        import functools
        import mission
        from robot import Arm

        @functools.lru_cache
        def arm():
            return Arm()

        def test_acts():
            mission.run(arm())

        def test_arrives():
            assert arm().x == 0.75
    """,
    "a class attribute": """
        import mission
        from robot import Arm

        class TestMission:
            arm = Arm()

            def test_acts(self):
                mission.run(self.arm)

            def test_arrives(self):
                assert self.arm.x == 0.75
    """,
    "a parametrised module fixture": """
        import mission, pytest
        from robot import Arm

        @pytest.fixture(scope="module", params=[0.0, 0.125])
        def arm(request):
            arm = Arm(request.param)
            arm.start = request.param
            mission.run(arm)
            return arm

        def test_is_there(arm):
            assert arm is not None

        def test_arrives(arm):
            assert arm.x == arm.start + 0.75
    """,
    "a tear-down that checks": """
        import mission, pytest
        from robot import Arm

        @pytest.fixture(scope="module")
        def arm():
            arm = Arm()
            yield arm
            assert arm.x == 0.75

        def test_acts(arm):
            mission.run(arm)
    """,
    "teardown_class checks": """
        import mission
        from robot import Arm

        class TestMission:
            @classmethod
            def setup_class(cls):
                cls.arm = Arm()

            @classmethod
            def teardown_class(cls):
                assert cls.arm.x == 0.75

            def test_acts(self):
                mission.run(self.arm)
    """,
    "a file that a later test reads": """
        import pathlib
        import mission
        from robot import Arm

        FILE = pathlib.Path(__file__).with_name("report.txt")

        def test_acts():
            arm = Arm()
            mission.run(arm)
            FILE.write_text(str(arm.x))

        def test_reads():
            assert FILE.read_text() == "0.75"
    """,
    "the program runs while the tests are imported": """
        import mission
        from robot import Arm

        ARM = Arm()
        mission.run(ARM)

        def test_a():
            assert ARM is not None

        def test_b():
            assert ARM.x == 0.75
    """,
    "the environment": """
        import os
        import mission
        from robot import Arm

        def test_acts():
            arm = Arm()
            mission.run(arm)
            os.environ["ARRIVED"] = str(arm.x)

        def test_looks():
            assert os.environ["ARRIVED"] == "0.75"
    """,
}


def judged(folder: Path, engine: str) -> dict[str, Outcome]:
    """Outcomes of the selected mutants, by operator."""
    path = run_campaign(request_for(folder, engine=engine, only=SELECTED), Quiet())
    return {outcome.mutant.rpartition(":")[2]: outcome for outcome in outcomes(path)}


#: those in the short run; all of them are in the long one
SHORT = ("a module fixture",)


@pytest.mark.parametrize(
    "suite", [pytest.param(name, marks=() if name in SHORT else pytest.mark.whole) for name in SUITES]
)
def test_whoever_looks_judges(tmp_path: Path, suite: str) -> None:
    write_project(tmp_path, MISSION, SUITES[suite])
    found = judged(tmp_path, "auto")
    assert found["reverse"].verdict is Verdict.KILLED
    assert found["reverse"].by is By.CHECK
    assert found["negate"].verdict is Verdict.SURVIVED


@pytest.mark.whole
@pytest.mark.parametrize("suite", ["a module fixture", "a simulator that the original puts back"])
def test_replay_alone_says_the_same(tmp_path: Path, suite: str) -> None:
    write_project(tmp_path, MISSION, SUITES[suite])
    found = judged(tmp_path, "replay")
    assert found["reverse"].verdict is Verdict.KILLED
    assert found["negate"].verdict is Verdict.SURVIVED


def test_an_independent_test_is_not_asked(tmp_path: Path) -> None:
    tests = """
        import mission
        from robot import Arm

        COUNT = 3

        def test_acts():
            mission.run(Arm())

        def test_else():
            assert COUNT == 3
    """
    write_project(tmp_path, MISSION, tests)
    found = judged(tmp_path, "branch")
    assert {(outcome.verdict, outcome.tests) for outcome in found.values()} == {(Verdict.SURVIVED, 1)}
