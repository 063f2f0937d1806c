"""What goes wrong in mutabot while it judges one mutant is an error of that mutant; the others are judged."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign import verdict
from mutabot.campaign.engines import forks, replay
from mutabot.errors import JournalError
from mutabot.model import Verdict
from tests.campaign.project import run, write_project
from tests.campaign.scripted import Script

MISSION = "def run(arm):\n    arm.move_by(0.25)\n    arm.move_by(-0.5)\n    where = arm.position()\n"
TESTS = """
    import mission
    from robot import Arm

    def test_run():
        arm = Arm()
        mission.run(arm)
        assert arm.x == -0.25
"""
CHOSEN = "mission.py:run:arm.move_by#2:dx:reverse"


@pytest.fixture
def project(tmp_path: Path, script: Script) -> Path:
    script.kill(CHOSEN, ":skip")
    return write_project(tmp_path, MISSION, TESTS)


@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_a_mutant_that_cannot_be_judged_is_an_error(
    project: Path, monkeypatch: pytest.MonkeyPatch, engine: str
) -> None:
    judged = verdict.judge

    def broken(campaign: Any, judgement: Any) -> Any:
        if judgement.mutant.id == CHOSEN:
            raise RuntimeError("broken")
        return judged(campaign, judgement)

    monkeypatch.setattr(verdict, "judge", broken)
    found = run(project, engine=engine)
    assert found[CHOSEN].verdict is Verdict.ERROR
    assert "mutabot could not judge what it saw of it: RuntimeError: broken" in (found[CHOSEN].message or "")
    others = {outcome.verdict for mutant, outcome in found.items() if mutant != CHOSEN}
    assert others == {Verdict.KILLED, Verdict.SURVIVED}


def test_a_report_of_a_worker_that_cannot_be_used_is_an_error(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_of = replay.run_of

    def broken(result: Any, sources: Any) -> Any:
        if result.task.job.mutant.id == CHOSEN:
            raise RuntimeError("broken")
        return run_of(result, sources)

    monkeypatch.setattr(replay, "run_of", broken)
    found = run(project, engine="replay")
    assert [mutant for mutant, outcome in found.items() if outcome.verdict is Verdict.ERROR] == [CHOSEN]


def test_a_report_of_a_fork_that_cannot_be_used_is_an_error(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended = forks._ForkRound._test_of_fork_ended

    def broken(self: Any, line: Any) -> Any:
        if line.mutant == CHOSEN:
            raise RuntimeError("broken")
        return ended(self, line)

    monkeypatch.setattr(forks._ForkRound, "_test_of_fork_ended", broken)
    found = run(project, engine="fork")
    assert [mutant for mutant, outcome in found.items() if outcome.verdict is Verdict.ERROR] == [CHOSEN]


def test_a_test_of_the_fork_parent_that_cannot_be_used_is_left_to_replay(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(self: Any, end: Any) -> Any:
        raise RuntimeError("broken")

    monkeypatch.setattr(forks._ForkRound, "_test_ended", broken)
    found = run(project, engine="auto")
    assert {outcome.engine for outcome in found.values()} == {"replay"}
    assert {outcome.verdict for outcome in found.values()} == {Verdict.KILLED, Verdict.SURVIVED}


def test_an_error_of_the_disk_is_none_of_the_mutant(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(campaign: Any, judgement: Any) -> Any:
        raise JournalError("the disk is full")

    monkeypatch.setattr(verdict, "judge", full)
    with pytest.raises(JournalError):
        run(project, engine="fork")
