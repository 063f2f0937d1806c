"""Mutants that act at some of the calls of a loop, by both engines."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.model import Moment, Outcome, Verdict
from tests.campaign.project import REPLAY, Quiet, request_for, write_project

ROBOT = """
    class Robot:
        def __init__(self): self.x, self.time, self.steps = 0.0, 0.0, []
        def step(self, dx):
            self.steps.append(dx)
            self.x += dx
            self.tick()
        def tick(self):
            self.time += 0.1
            return self.time
"""
VOCABULARY = """
    clock = { tick = "robot:Robot.tick", unit = "s" }

    [[operation]]
    call = "robot:Robot.step"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
"""
MISSION = """
    def run(robot):
        for _ in range(50):
            robot.step(0.01)
"""
#: the test itself writes down at which calls its robot heard something else
TESTS = """
    import mission
    from robot import Robot

    def test_run():
        robot = Robot()
        mission.run(robot)
        wrong = [number for number, dx in enumerate(robot.steps, start=1) if dx != 0.01]
        assert not wrong, f"calls {wrong}"
"""

#: runs *reverse* at a moment, in so many rounds
Run = Callable[..., list[Outcome]]


@pytest.fixture(params=["fork", REPLAY])
def outcome(request: pytest.FixtureRequest, tmp_path: Path) -> Run:
    """Runs *reverse* at a moment, and returns its outcome."""

    def run(moment: str, rounds: int = 1) -> list[Outcome]:
        folder = write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)
        wanted = request_for(
            folder, engine=request.param, only=("reverse",), moments=(Moment.parse(moment),), rounds=rounds
        )
        with Journal.open(run_campaign(wanted, Quiet())) as journal:
            return journal.outcomes()

    return run


def calls_of(outcome: Outcome) -> list[int]:
    assert outcome.verdict is Verdict.KILLED
    inside = outcome.message.partition("calls [")[2].partition("]")[0]
    return [int(number) for number in inside.split(",")]


def test_one_call_alone_is_wrong(outcome: Run) -> None:
    assert calls_of(outcome("7")[0]) == [7]


def test_all_calls_from_one_on_are_wrong(outcome: Run) -> None:
    assert calls_of(outcome("from 48")[0]) == [48, 49, 50]


def test_calls_in_a_window_of_simulated_time_are_wrong(outcome: Run) -> None:
    # the first tick is at 0.1 s, so call 12 begins 1 s after it
    assert calls_of(outcome("0.95-1.25 s")[0]) == [12, 13, 14]


def test_a_drawn_call_is_one_in_each_round_and_not_always_the_same(outcome: Run) -> None:
    drawn = [calls_of(end) for end in outcome("once", rounds=4)]
    assert all(len(calls) == 1 for calls in drawn)
    assert len({calls[0] for calls in drawn}) > 1


@pytest.mark.whole
def test_both_engines_draw_alike(tmp_path: Path) -> None:
    ends = []
    for engine in ("fork", "replay"):
        folder = write_project(tmp_path / engine, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)
        wanted = request_for(folder, engine=engine, only=("skip",), moments=(Moment.parse("once"),), rounds=2)
        with Journal.open(run_campaign(wanted, Quiet())) as journal:
            ends.append([(end.round, end.verdict) for end in journal.outcomes()])
    assert sorted(ends[0]) == sorted(ends[1])


def test_a_call_that_no_test_makes_is_left_out(tmp_path: Path) -> None:
    folder = write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)
    wanted = request_for(folder, moments=(None, Moment.parse("51")))
    with Journal.open(run_campaign(wanted, Quiet())) as journal:
        assert {omission.reason for omission in journal.left_out()} == {
            "no test makes call 51 here; the most are 50"
        }
        assert all(mutant.moment is None for mutant in journal.mutants())
