"""Ctrl-C in a campaign of forks: what has ended counts if its test ends in the original as it should."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from mutabot.campaign.engines.forks import _ForkRound
from mutabot.campaign.run import run_campaign
from mutabot.journal.reader import JournalReader
from mutabot.model import Outcome, Verdict
from mutabot.model.events import Event, ForkSessionEnd, ForkTestEnd
from tests.campaign.project import Quiet, request_for, write_project
from tests.campaign.scripted import CHECKED, Script

MISSION = """
    def approach(arm):
        arm.move_by(0.25)
        arm.move_by(0.5)

    def retreat(arm):
        arm.move_by(-0.5)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_approach():
        arm = Arm()
        mission.approach(arm)
        assert arm.x > 0.25

    def test_retreat():
        arm = Arm()
        mission.retreat(arm)
        assert arm.x == -0.5
"""
#: the original waits in its second test until it is told that forks are wanted no more
WAITING = """
    import os, time
    import mission
    from robot import Arm

    FORKED, BEFORE = [], []
    os.register_at_fork(after_in_child=lambda: FORKED.append(True))

    def test_approach():
        BEFORE[:] = FORKED
        arm = Arm()
        mission.approach(arm)
        assert arm.x > 0.25

    def test_retreat():
        folder = os.environ["MUTABOT_PROCESSES"]
        home, until = os.path.dirname(folder), time.monotonic() + 60
        waits = "WAITS" in os.environ and FORKED == BEFORE
        if waits:
            with open(f"{folder}/job", "rb") as job:
                waits = b"Forking" in job.read()
        while waits and not os.path.exists(f"{home}/stop") and time.monotonic() < until:
            time.sleep(0.01)
        arm = Arm()
        mission.retreat(arm)
        assert arm.x == -0.5
"""
Verdicts = dict[str, Verdict]


def interrupted(folder: Path) -> tuple[Verdicts, list[str]]:
    """What the journal holds of a campaign that somebody interrupts, and what the progress line counted."""
    request, progress = request_for(folder, engine="fork", repeats=False), Quiet()
    with pytest.raises(KeyboardInterrupt):
        run_campaign(request, progress)
    with JournalReader.open(request.journal_path) as journal:
        assert journal.finished == "interrupted"
        found = {outcome.mutant: outcome.verdict for outcome in journal.outcomes()}
    return found, [line for line in progress.lines if line.startswith("#")]


def is_control(mutant: str) -> bool:
    return "=tests/" in mutant


def after(count: int, told: list[str]) -> Callable[[Event], bool]:
    """Whether so many tests have ended as mutants; ``told``: takes these mutants."""

    def is_time(event: Event) -> bool:
        if isinstance(event, ForkTestEnd) and not is_control(event.mutant):
            told.append(event.mutant)
            return len(told) == count
        return False

    return is_time


def test_forks_that_have_ended_are_in_the_journal_and_others_are_not(tmp_path: Path, script: Script) -> None:
    write_project(tmp_path, MISSION, TESTS)
    told: list[str] = []
    script.kill("approach")
    script.interrupts = after(3, told)
    found, counted = interrupted(tmp_path)
    assert found == dict.fromkeys(told, Verdict.KILLED)
    assert len(counted) == len(found)


def test_forks_count_no_more_than_without_if_their_test_ends_otherwise(
    tmp_path: Path, script: Script
) -> None:
    write_project(tmp_path, MISSION, TESTS)
    script.kill("approach")
    script.interrupts = after(3, [])
    script.original = lambda run: CHECKED if run.before else {}
    assert interrupted(tmp_path) == ({}, [])


def test_a_real_campaign_goes_on_where_it_was_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_project(tmp_path, MISSION, WAITING)
    ended: set[str] = set()
    pressed: list[bool] = []
    take = _ForkRound.take

    def taken(parent: _ForkRound, event: Event) -> Iterator[Outcome]:
        if isinstance(event, ForkTestEnd) and event.end.is_decided:
            ended.add(event.mutant)
        elif isinstance(event, ForkSessionEnd):
            if not pressed and not all(map(is_control, event.mutants)):  # the first that survives
                pressed.append(True)
                signal.raise_signal(signal.SIGINT)
            ended.update(event.mutants)
        return take(parent, event)

    with monkeypatch.context() as patch:
        patch.setattr(_ForkRound, "take", taken)
        patch.setenv("WAITS", "yes")
        found, counted = interrupted(tmp_path)
    assert found.keys() >= {mutant for mutant in ended if not is_control(mutant)}
    assert {*found.values()} == {Verdict.KILLED, Verdict.SURVIVED}
    assert len(counted) == len(found)
    request = request_for(tmp_path, engine="fork", repeats=False)
    with JournalReader.open(run_campaign(request, Quiet())) as journal:
        assert {mutant for mutant, _ in journal.reused()} == found.keys()
        assert {outcome.mutant: outcome.verdict for outcome in journal.outcomes()}.items() >= found.items()
        assert len(journal.outcomes()) == len(journal.mutants()) > len(found)
