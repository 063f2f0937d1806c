"""Calls that the robot refuses in the original too: their mutants are judged by the tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import plan_only
from mutabot.model import By, Outcome, Verdict
from tests.campaign.project import Quiet, by_forks, request_for, write_project

MISSION = """
    from robot import Refused

    def too_far(arm):
        arm.move_by(5.0)

    def too_far_told(arm):
        arm.move_by(5.0)

    def near(arm):
        arm.move_by(0.75)

    def try_all(arm, amounts):
        refused = 0
        for amount in amounts:
            try:
                arm.move_by(amount)
            except Refused:
                refused += 1
        return refused
"""
TESTS = """
    import mission
    import pytest
    from robot import Arm, Refused

    def test_too_far():
        with pytest.raises(Refused):
            mission.too_far(Arm())

    def test_too_far_told():
        with pytest.raises(Refused, match="^5.0 is out of reach"):
            mission.too_far_told(Arm())

    def test_near():
        arm = Arm(-0.5)
        mission.near(arm)
        assert arm.x == 0.25

    def test_some_are_refused():
        arm = Arm()
        assert mission.try_all(arm, [5.0, 0.25]) == 1
        assert arm.x == 0.25
"""
#: at one site: refused in the original at the first call alone, the mutant at both; nothing is checked
BOTH_REFUSED = """
    import mission
    from robot import Arm

    def test_some_are_refused():
        mission.try_all(Arm(-0.5), [5.0, 0.75])
"""


def by_name(outcomes: dict[tuple[str, int], Outcome]) -> dict[str, Outcome]:
    return {id.split(":", 1)[1].replace("#1", ""): outcome for (id, _), outcome in outcomes.items()}


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Outcome]:
    return by_name(by_forks(write_project(tmp_path_factory.mktemp("refused"), MISSION, TESTS)))


def test_a_refusal_that_the_tests_expect_is_judged_by_them(found: dict[str, Outcome]) -> None:
    # −5 is refused as 5 is: pytest.raises is satisfied with either
    assert found["too_far:arm.move_by:dx:reverse"].verdict is Verdict.SURVIVED
    told = found["too_far_told:arm.move_by:dx:reverse"]
    assert (told.verdict, told.by) == (Verdict.KILLED, By.CHECK)
    assert "Regex pattern did not match" in (told.message or "")
    some = found["try_all:arm.move_by:dx:reverse"]
    assert (some.verdict, some.by) == (Verdict.KILLED, By.CHECK)
    # what the original was not refused is refused as ever
    near = found["near:arm.move_by:dx:reverse"]
    assert (near.verdict, near.message) == (Verdict.REFUSED, "-1.25 is out of reach")


def test_only_calls_that_the_original_is_refused_count_at_a_site(tmp_path: Path) -> None:
    found = by_name(by_forks(write_project(tmp_path, MISSION, BOTH_REFUSED)))
    some = found["try_all:arm.move_by:dx:reverse"]
    assert (some.verdict, some.message) == (Verdict.REFUSED, "-1.25 is out of reach")


def test_a_skipped_call_that_never_returns_answers_nothing_as_the_others_do(
    found: dict[str, Outcome],
) -> None:
    skipped = found["too_far:arm.move_by:call:skip"]
    assert (skipped.verdict, skipped.by) == (Verdict.KILLED, By.CHECK)
    assert "DID NOT RAISE" in (skipped.message or "")


@pytest.mark.parametrize(
    ("answer", "others"), [("return self.x", ""), ("", "never")], ids=["something", "nothing known"]
)
def test_a_skipped_call_of_which_nobody_knows_the_answer_is_left_out(
    tmp_path: Path, answer: str, others: str
) -> None:
    """The command answers something elsewhere, which tells nothing of this call; or is refused everywhere."""
    robot = f"""
        class Refused(Exception):
            pass

        class Arm:
            def __init__(self, x=0.0):
                self.x = x

            def move_by(self, dx):
                if not -1.0 <= self.x + dx <= 1.0:
                    raise Refused(f"{{self.x + dx}} is out of reach")
                self.x += dx
                {answer or "pass"}
    """
    tests = TESTS.partition("def test_too_far_told")[0] if others else TESTS
    vocabulary = """
        refusals = ["robot:Refused"]

        [[operation]]
        call = "robot:Arm.move_by"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    """
    write_project(tmp_path, MISSION, tests, robot=robot, vocabulary=vocabulary)
    left_out = plan_only(request_for(tmp_path), Quiet()).left_out
    reasons = {omission.id: omission.reason for omission in left_out}
    assert "no recorded call returned" in reasons["mission.py:too_far:arm.move_by#1:call:skip"]


@pytest.mark.needs("source")
@pytest.mark.whole
def test_a_mutant_of_the_text_is_judged_by_the_tests_as_well(tmp_path: Path) -> None:
    """One number for another: the robot refuses either, and the test expects which."""
    write_project(tmp_path, MISSION, TESTS)
    outcomes = by_forks(tmp_path, families=("conventional",))
    told = [outcome for (id, _), outcome in outcomes.items() if id.startswith("mission.py:too_far_told:5.0")]
    assert told
    refused_as_well = [outcome for outcome in told if "out of reach" in (outcome.message or "")]
    assert refused_as_well
    assert {(outcome.verdict, outcome.by) for outcome in refused_as_well} == {(Verdict.KILLED, By.CHECK)}
    near = [outcome for (id, _), outcome in outcomes.items() if id.startswith("mission.py:near:0.75")]
    assert Verdict.REFUSED in {outcome.verdict for outcome in near}


ANSWERING = """
    from dataclasses import dataclass

    @dataclass
    class Reply:
        status: int

    class Arm:
        def __init__(self):
            self.x = 0.0

        def move_to(self, x):
            if not -1.0 <= x <= 1.0:
                return Reply(5)
            self.x = x
            return Reply(0)
"""
STATUS = """
    refusals = []

    [[operation]]
    call = "robot:Arm.move_to"
    arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "to", ladder = [0.5, 5.0] }
    refused = { path = "status", values = [5] }
"""
MISSION_WITH_STATUS = """
    def too_far(arm):
        return arm.move_to(3.0).status

    def there(arm):
        return arm.move_to(0.75).status
"""
TESTS_OF_STATUS = """
    import mission
    from robot import Arm

    def test_too_far():
        assert mission.too_far(Arm()) == 5

    def test_there():
        assert mission.there(Arm()) == 0
"""


@pytest.mark.whole
def test_a_refusal_by_data_that_the_original_gets_as_well_is_judged_by_the_tests(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION_WITH_STATUS, TESTS_OF_STATUS, robot=ANSWERING, vocabulary=STATUS)
    found = by_name(by_forks(tmp_path, families=("robot", "graded")))
    assert found["too_far:arm.move_to:x:reverse"].verdict is Verdict.SURVIVED
    # there the original is not refused
    graded = {
        outcome.verdict for name, outcome in found.items() if name.startswith("there:arm.move_to:x:offset=+")
    }
    assert Verdict.REFUSED in graded


@pytest.mark.whole
def test_a_refusal_in_a_process_below_the_tests_is_known_as_well(tmp_path: Path) -> None:
    mission = """
        import sys
        from robot import Arm, Refused

        def too_far(arm):
            arm.move_by(5.0)

        if __name__ == "__main__":
            try:
                too_far(Arm())
            except Refused:
                sys.exit(3)
    """
    tests = """
        import os, subprocess, sys

        def test_it_says_that_it_is_refused():
            assert subprocess.run([sys.executable, "mission.py"], env=os.environ).returncode == 3
    """
    outcomes = by_forks(write_project(tmp_path, mission, tests))
    reverse = next(outcome for (id, _), outcome in outcomes.items() if id.endswith(":reverse"))
    assert (reverse.verdict, reverse.acted) == (Verdict.SURVIVED, 1)
