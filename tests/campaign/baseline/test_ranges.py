"""Values beyond the range that the vocabulary gives: who limits them, and what mutants do about it."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import check, plan_only
from mutabot.campaign.run import run_campaign
from mutabot.model import Outcome, Verdict
from tests.campaign.project import CONFIGURATION, REPLAY, Quiet, outcomes, request_for, write_project

ROBOT = """
    class Env:
        def __init__(self):
            self.x = 0.0

        def step(self, push):
            self.x += min(max(push, -1.0), 1.0)
"""
MISSION = """
    def run(env):
        for push in (0.5, 1.7, 3.0, 0.0):
            env.step(push)
"""
TESTS = """
    import mission, robot

    def test_it():
        env = robot.Env()
        mission.run(env)
        assert env.x > {least}
"""
REMARK = (
    "robot.toml:2 · robot:Env.step · arguments.push: 2 of 4 recorded values are outside range = [-1, 1], "
    "such as 1.7 m, and mutants stay away from what is outside; "
    "give it clip = [-1, 1] if the robot limits what it is sent, else a wider range"
)


def project(folder: Path, more: str = "", least: float = 1.0) -> Path:
    quantity = f'kind = "translation", axis = "x", unit = "m", mode = "by", range = [-1, 1]{more}'
    vocabulary = f'\n[[operation]]\ncall = "robot:Env.step"\narguments.push = {{ {quantity} }}\n'
    configuration = CONFIGURATION + "    rounds = 1\n"
    tests = TESTS.format(least=least)
    return write_project(
        folder, MISSION, tests, robot=ROBOT, vocabulary=vocabulary, configuration=configuration
    )


def reversed_in(folder: Path, engine: str) -> tuple[Outcome, list[str]]:
    told = Quiet()
    path = run_campaign(request_for(folder, engine=engine, only=("reverse",)), told)
    (outcome,) = outcomes(path)
    return outcome, told.lines


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_a_mutant_stays_away_from_what_is_out_of_range_and_says_so(engine: str, tmp_path: Path) -> None:
    outcome, lines = reversed_in(project(tmp_path), engine)
    assert (outcome.verdict, outcome.acted, outcome.hits) == (Verdict.SURVIVED, 1, 4)
    assert outcome.away == {
        "the value would leave the range [-1, 1]": 2,
        "the value would stay the same": 1,
    }
    assert lines.count(REMARK) == 1


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_what_the_robot_limits_itself_may_be_sent(engine: str, tmp_path: Path) -> None:
    outcome, lines = reversed_in(project(tmp_path, ", clip = [-1, 1]"), engine)
    assert (outcome.verdict, outcome.acted, outcome.hits) == (Verdict.KILLED, 3, 4)
    assert outcome.away == {"the value would stay the same": 1}
    assert not any("recorded values" in line for line in lines)


def test_check_reports_what_is_out_of_range(tmp_path: Path) -> None:
    told = Quiet()
    report = check(request_for(project(tmp_path), engine="fork"), told)
    assert f"note      {REMARK}" in report.lines
    assert REMARK not in told.lines  # it is told once
    assert REMARK.rpartition(": ")[2] in str(report.data["remarks"])


def test_a_description_names_the_operation_where_the_call_does_not(tmp_path: Path) -> None:
    robot = """
        class Arm:
            def lift(self): pass
            def drop(self): pass
            def park(self): pass
        """
    mission = """
        def run(arm):
            for name in ("lift", "drop"):
                getattr(arm, name)()
            go = arm.park
            go()
            arm.park()
        """
    tests = """
        import mission, robot

        def test_it():
            mission.run(robot.Arm())
        """
    vocabulary = "\n".join(f'[[operation]]\ncall = "robot:Arm.{name}"\n' for name in ("lift", "drop", "park"))
    folder = write_project(tmp_path, mission, tests, robot=robot, vocabulary=vocabulary)
    mutants = plan_only(request_for(folder, rounds=1, only=("skip",)), Quiet()).mutants
    assert [mutant.description for mutant in mutants] == [
        "getattr(arm, name) (Arm.lift): do nothing",
        "getattr(arm, name) (Arm.drop): do nothing",
        "go (Arm.park): do nothing",
        "arm.park: do nothing",
    ]
