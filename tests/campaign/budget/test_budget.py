"""A campaign in limited time: what comes first, and an end in time."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign import schedule
from mutabot.campaign.run import run_campaign
from mutabot.campaign.schedule import in_order
from mutabot.execution.interruption import OutOfTimeError, interruptible, interruptions_kept, limited
from mutabot.journal.journal import Journal
from mutabot.model import Mutant, Role, Site, Span, Verdict
from mutabot.results.results import read_results
from tests.campaign.project import Quiet, request_for, write_project

MISSION = """
    import time

    def go(arm):
        for length in (0.1, 0.2, 0.05):
            arm.move_by(length)
        time.sleep(0.05)
        arm.move_by(0.1)
        return arm.position()
"""
TESTS = """
    from robot import Arm
    import mission

    def test_goes():
        assert mission.go(Arm()) > 0.4
"""


def mutant(number: int, line: int, operator: str = "skip") -> Mutant:
    site = Site(Span("a.py", line, 0, line, 5, "go"), "call", line, Role.PROGRAM)
    return Mutant(number, "robot", operator, site, "a:b", None, None, "", "")


MUTANTS = [mutant(1, 1), mutant(2, 1, "repeat"), mutant(3, 2), mutant(4, 2, "repeat"), mutant(5, 3)]


def test_what_was_never_run_comes_first_then_survivors_and_the_rest() -> None:
    before = {
        (MUTANTS[1].id, 0): Verdict.SURVIVED, (MUTANTS[2].id, 0): Verdict.KILLED,
        (MUTANTS[3].id, 0): Verdict.KILLED, (MUTANTS[4].id, 0): Verdict.REFUSED,
    }  # fmt: skip
    trials = in_order(MUTANTS, 1, [(MUTANTS[4].id, 0)], 1, before)
    assert [item.number for item, _ in trials] == [1, 2, 3, 4]


def test_every_outcome_comes_once_each_site_first_and_one_round_after_the_other() -> None:
    trials = in_order(MUTANTS, 2, [], 1, {})
    pairs = [(item.id, round) for item, round in trials]
    assert sorted(pairs) == sorted((item.id, round) for item in MUTANTS for round in range(2))
    assert len({item.site for item, _ in trials[:3]}) == 3
    assert [round for _, round in trials] == [0] * 5 + [1] * 5


def test_the_end_of_the_time_waits_until_it_is_safe() -> None:
    reached = False
    with interruptions_kept(), limited(time.monotonic() + 0.01, time.monotonic):
        until = time.monotonic() + 0.1
        while time.monotonic() < until:
            pass
        reached = True
        with pytest.raises(OutOfTimeError), interruptible():
            time.sleep(5)
    assert reached


@pytest.fixture
def project(tmp_path: Path) -> Path:
    return write_project(tmp_path, MISSION, TESTS)


def campaign(folder: Path, **changes: Any) -> Any:
    path = run_campaign(request_for(folder, **changes), Quiet())
    with Journal.open(path) as journal:
        return read_results(journal)


@pytest.mark.usefixtures("script")
def test_a_spent_budget_leaves_the_rest_to_the_next_run(project: Path) -> None:
    results = campaign(project, budget=0.001)
    assert results.state == "out of time"
    assert results.done < results.planned
    assert results.budget is not None
    assert not results.budget.is_whole
    assert results.budget.run + results.budget.cut_off == results.done < results.budget.planned
    whole = campaign(project)
    assert (whole.state, whole.done, whole.budget) == ("complete", whole.planned, None)


@pytest.mark.usefixtures("script")
def test_a_budget_that_is_enough_gives_what_a_campaign_without_one_gives(project: Path) -> None:
    results = campaign(project, budget=600.0)
    assert results.state == "complete"
    assert results.budget is not None
    assert results.budget.is_whole
    assert (results.budget.run, results.budget.cut_off) == (results.budget.planned, 0)
    fresh = campaign(project, fresh=True)
    assert [[outcome.verdict for outcome in result.outcomes] for result in results.mutants] == [
        [outcome.verdict for outcome in result.outcomes] for result in fresh.mutants
    ]


@pytest.mark.whole
def test_what_is_under_way_when_the_time_is_up_gets_no_verdict(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (project / "mission.py").write_text(
        (project / "mission.py").read_text().replace("sleep(0.05)", "sleep(1.0)")
    )
    monkeypatch.setattr(schedule, "_FIRST", 1000)
    results = campaign(project, budget=3.5)
    assert results.done < results.planned
    assert results.state == "out of time"
    assert not any(outcome.verdict in (Verdict.ERROR, Verdict.TIMEOUT) for outcome in (
        outcome for result in results.mutants for outcome in result.outcomes
    ))  # fmt: skip
    assert (results.budget.run, results.budget.cut_off) == (0, results.done)
