"""What a mutant may take for a test follows what that took on the original, not how often it calls."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.run import run_campaign
from mutabot.model import Operation, Verdict, Vocabulary
from mutabot.model.deadline import Limit
from mutabot.model.events import TestEnd
from tests.campaign.project import REPLAY, Quiet, outcomes, request_for, write_project

CALLS = Vocabulary((Operation("robot:move", ()),))


def campaign(
    vocabulary: Vocabulary = CALLS, *, least: float | None = None, is_short: bool = False
) -> Campaign:
    configuration = SimpleNamespace(timeout_factor=10.0, timeout_seconds=least)
    request: Any = SimpleNamespace(configuration=configuration, vocabulary=vocabulary)
    ends = {
        (0, "long"): TestEnd("long", "passed", wall=20.0, cpu=3.0, simulated=4.0),
        (0, "short"): TestEnd("short", "passed", wall=0.1, cpu=0.1),
    }
    nobody: Any = None
    return Campaign(
        request, Baseline(tests=[["long", "short"]], ends=ends), nobody, nobody, is_short=is_short
    )


def test_a_test_may_take_a_multiple_of_the_baseline_and_what_a_poll_loop_takes() -> None:
    assert campaign().limits(0, ("long", "short")) == {"long": Limit(200.0, 40.0), "short": Limit(60.0, 11.0)}


def test_where_no_calls_are_seen_a_loop_is_ended_sooner() -> None:
    assert campaign(Vocabulary(())).limits(0, ("long", "short"))["short"] == Limit(60.0, 3.0)


def test_what_the_user_sets_is_the_least_of_all_limits() -> None:
    found = campaign(least=5.0)
    assert found.limits(0, ("long", "short")) == {"long": Limit(200.0, 30.0), "short": Limit(5.0, 5.0)}
    assert found.startup_limit == Limit(5.0, 5.0)


@pytest.mark.parametrize("is_short", [False, True])
def test_a_test_may_have_to_prepare_what_tests_that_are_left_out_prepare_in_the_suite(is_short: bool) -> None:
    tests = ("long", "short") if is_short else ("short",)
    assert campaign(is_short=is_short).limits(0, tests)["short"] == Limit(80.0, 14.0)


POLLS = """
    def settle(arm):
        looked = 0
        arm.move_by(0.5)
        while arm.position() < 0.5 and looked < 3000:
            looked += 1
        return looked
    """
TESTS = """
    import mission
    from robot import Arm

    def test_settles():
        assert mission.settle(Arm()) >= 0
    """


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_a_poll_loop_that_ends_is_no_time_out(tmp_path: Path, engine: str) -> None:
    project = write_project(tmp_path, POLLS, TESTS)
    found = outcomes(run_campaign(request_for(project, engine=engine, rounds=1, only=("*:skip",)), Quiet()))
    assert {outcome.verdict for outcome in found} == {Verdict.SURVIVED}
