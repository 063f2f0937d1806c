"""A mutant that changes which tests there are is judged by those that it leaves and those that it makes."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.verdict import Run, _collected_otherwise, _ruling
from mutabot.model import Mutant, Role, Site, Span, Verdict
from mutabot.model.events import TestEnd
from tests.campaign.project import REPLAY, run, write_project

SITE = Site(Span("m.py", 1, 0, 1, 9, "<module>"), "arm.move", 1, Role.PROGRAM)
MUTANT = Mutant(1, "robot", "skip", SITE, "robot:Arm.move", None, None, "", "")
TESTS = ("t.py::test_a", "t.py::test_b")


def passed(test: str) -> TestEnd:
    return TestEnd(test, "passed", hits=1, acted=1)


def test_a_suite_that_passes_without_some_of_its_tests_lets_a_mutant_through_and_is_reported() -> None:
    ends = [passed(TESTS[0]), passed("t.py::test_new")]
    found = Run(MUTANT, 0, TESTS, ends, exit_code=0, gone=(TESTS[1],), has_acted=True)
    assert _ruling(found, 0)[0] is Verdict.SURVIVED
    assert _collected_otherwise(found) == (
        "t.py::test_b not collected",
        "collected beside the original's tests: t.py::test_new",
    )


@pytest.mark.parametrize(("has_acted", "verdict"), [(True, Verdict.KILLED), (False, Verdict.UNSTABLE)])
def test_a_suite_that_a_mutant_leaves_without_tests_ends_otherwise(
    *, has_acted: bool, verdict: Verdict
) -> None:
    found = Run(MUTANT, 0, TESTS, exit_code=5, gone=TESTS, has_acted=has_acted)
    assert _ruling(found, 0)[0] is verdict


MISSION = """
    from robot import Arm

    ARM = Arm()
    ARM.move_by(0.5)
    PLACES = [0.25, ARM.position()]
"""
SUITE = """
    import mission
    import pytest

    if mission.ARM.x < 0:
        pytest.skip("nothing to test", allow_module_level=True)

    @pytest.mark.parametrize("place", mission.PLACES)
    def test_place(place):
        assert 0 < place < 0.75
"""


@pytest.mark.parametrize("engine", [REPLAY, "fork"])
def test_tests_that_a_mutant_makes_judge_it(tmp_path: Path, engine: str) -> None:
    write_project(tmp_path, MISSION, SUITE)
    ends = run(tmp_path, engine=engine)
    found = {
        name.partition("#")[2]: (outcome.verdict, outcome.test)
        for name, outcome in ends.items()
        if "move" in name
    }
    assert found == {
        "1:call:skip": (Verdict.KILLED, "tests/test_mission.py::test_place[0.0]"),
        "1:call:repeat": (Verdict.KILLED, "tests/test_mission.py::test_place[1.0]"),
        "1:dx:reverse": (Verdict.KILLED, None),  # no test is left
    }
