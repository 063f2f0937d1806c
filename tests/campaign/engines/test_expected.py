"""Tests that are skipped or fail as expected judge as they do in pytest: what makes the suite fail kills."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import By, Outcome, Verdict
from tests.campaign.project import Quiet, by_forks, no_private_files, outcomes, request_for, write_project
from tests.campaign.scripted import Script

FUNCTIONS = ("strict", "lenient", "typed", "busy", "maybe", "gives_up", "expected", "inverse")
MISSION = "\n".join(f"def {name}(arm):\n    arm.move_by(0.25)\n" for name in FUNCTIONS)
TESTS = """
    import unittest

    import mission
    import pytest
    from robot import Arm

    @pytest.mark.xfail(strict=True, reason="goes the wrong way")
    def test_strict():
        arm = Arm()
        mission.strict(arm)
        assert arm.x < 0

    @pytest.mark.xfail(reason="goes the wrong way")
    def test_lenient():
        arm = Arm()
        mission.lenient(arm)
        assert arm.x < 0

    @pytest.mark.xfail(raises=AssertionError, strict=True)
    def test_typed():
        arm = Arm()
        mission.typed(arm)
        if arm.x == 0:
            raise KeyError("stands still")
        assert arm.x > 1

    def test_busy():
        arm = Arm()
        mission.busy(arm)
        if arm.x > 0:
            pytest.skip("busy")
        assert arm.x == 1

    def test_maybe():
        arm = Arm()
        mission.maybe(arm)
        if arm.x <= 0:
            pytest.skip("not there")

    def test_gives_up():
        arm = Arm()
        mission.gives_up(arm)
        if arm.x <= 0:
            pytest.xfail("not there")

    class TestCase(unittest.TestCase):
        @unittest.expectedFailure
        def test_expected(self):
            arm = Arm()
            mission.expected(arm)
            self.assertLess(arm.x, 0)

    @pytest.mark.skip
    def test_never():
        raise AssertionError

    @pytest.mark.skipif(False, reason="runs")
    def test_inverse():
        arm = Arm()
        mission.inverse(arm)
        assert arm.x == 0.25
"""
WRONG_WAY = "[XPASS(strict)] goes the wrong way"
CHECK, EXCEPTION = (Verdict.KILLED, By.CHECK), (Verdict.KILLED, By.EXCEPTION)
SURVIVED = (Verdict.SURVIVED, None)
#: what plain pytest says of the program edited by hand
EXPECTED = {
    "strict": {"reverse": CHECK, "skip": SURVIVED, "repeat": SURVIVED},
    "lenient": {"reverse": SURVIVED, "skip": SURVIVED, "repeat": SURVIVED},
    "typed": {"reverse": SURVIVED, "skip": EXCEPTION, "repeat": SURVIVED},
    "busy": {"reverse": CHECK, "skip": CHECK, "repeat": SURVIVED},
    "maybe": {"reverse": SURVIVED, "skip": SURVIVED, "repeat": SURVIVED},
    "gives_up": {"reverse": SURVIVED, "skip": SURVIVED, "repeat": SURVIVED},
    "expected": {"reverse": CHECK, "skip": SURVIVED, "repeat": SURVIVED},
    "inverse": {"reverse": CHECK, "skip": CHECK, "repeat": CHECK},
}


def by_function(found: dict[tuple[str, int], Outcome]) -> dict[str, dict[str, Outcome]]:
    table: dict[str, dict[str, Outcome]] = {}
    for (mutant, _), outcome in found.items():
        parts = mutant.split(":")
        table.setdefault(parts[1], {})[parts[-1]] = outcome
    return table


def test_all_that_makes_the_suite_fail_kills_and_nothing_else(tmp_path: Path) -> None:
    found = by_function(by_forks(write_project(tmp_path, MISSION, TESTS)))
    ends = {
        name: {operator: (value.verdict, value.by) for operator, value in row.items()}
        for name, row in found.items()
    }
    assert ends == EXPECTED
    assert found["strict"]["reverse"].message == WRONG_WAY
    assert found["expected"]["reverse"].message == "Unexpected success"
    assert found["strict"]["reverse"].engine == ("replay" if no_private_files() else "fork")
    # the suite passes, but the world is not the original's
    for name, end in (("maybe", "skipped"), ("gives_up", "xfailed")):
        outcome = found[name]["skip"]
        assert outcome.divergence[0] == f"the test ended {end} instead of passed"
        assert not outcome.indistinguishable
    assert found["lenient"]["reverse"].divergence[0] == "the test ended xpassed instead of xfailed"


ONE_TEST = """
    import mission
    from robot import Arm

    def test_flickers():
        mission.strict(Arm())
"""


@pytest.mark.parametrize("engine", ["replay", "fork"])
def test_a_test_that_may_fail_is_not_flaky_if_it_passes_now_and_then(
    tmp_path: Path, script: Script, engine: str
) -> None:
    script.original = lambda run: {"outcome": "xpassed" if run.before % 2 else "xfailed"}
    script.mutated = lambda run: {"outcome": "xpassed"}
    folder = write_project(tmp_path, MISSION, ONE_TEST)
    progress = Quiet()
    path = run_campaign(request_for(folder, engine=engine), progress)
    assert not [line for line in progress.lines if "flaky" in line]
    found = [outcome for outcome in outcomes(path) if outcome.verdict is not Verdict.NOT_COVERED]
    assert {outcome.verdict for outcome in found} == {Verdict.SURVIVED}
    assert {outcome.indistinguishable for outcome in found} == {None}  # nobody knows


DIVERGES = """
    import mission
    import pytest
    from robot import Arm, Diverged

    @pytest.mark.xfail(raises=Diverged)
    def test_diverges():
        mission.strict(Arm())
        raise Diverged("NaN")

    def test_moves():
        arm = Arm()
        mission.strict(arm)
        assert arm.x == 0.25
"""


def test_a_test_in_which_the_simulator_is_to_fail_judges_nothing(tmp_path: Path) -> None:
    found = by_forks(write_project(tmp_path, MISSION, DIVERGES))
    assert {(outcome.verdict, outcome.test) for outcome in found.values() if outcome.test is not None} == {
        (Verdict.KILLED, "tests/test_mission.py::test_moves")
    }
