"""Which tasks get free places: a fork parent is left one to fork with until it has ended a test."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.execution.workers import TokenPool, Workers
from mutabot.journal.reader import JournalReader
from tests.campaign.project import Quiet, request_for, write_project

MISSION = """
    def go(arm):
        arm.move_by(0.25)
        return arm.position()
"""
TESTS = """
    import mission
    from robot import Arm

    def test_goes():
        assert mission.go(Arm()) == 0.25

    def test_is_there():
        assert mission.go(Arm(0.5)) > 0
"""


@pytest.fixture
def pool() -> Iterator[TokenPool]:
    with closing(TokenPool(3)) as pool:
        yield pool


def test_a_token_is_taken_only_beside_those_that_are_spared(pool: TokenPool) -> None:
    assert not pool.take(beside=3)
    assert [pool.take(beside=2), pool.take(beside=2)] == [True, False]
    assert [pool.take(beside=1), pool.take(beside=1)] == [True, False]
    assert [pool.take(), pool.take()] == [True, False]
    pool.give_back(1)
    assert not pool.take(beside=1)
    assert pool.take()


@pytest.mark.parametrize("jobs", [2, 4])
def test_a_fork_parent_begins_beside_a_token_for_each_other_that_has_ended_no_test(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, jobs: int
) -> None:
    """How many begin is a matter of time: a parent that waits for its controls gives its own token back."""
    spared: list[int] = []
    needed: list[int] = []
    take, start = TokenPool.take, Workers._start

    def taken(pool: TokenPool, *, beside: int = 0) -> bool:
        is_taken = take(pool, beside=beside)
        if is_taken:
            spared.append(beside)
        return is_taken

    def started(workers: Workers, task: Any) -> None:
        if task.is_fork_parent:
            needed.append(
                sum(worker.task.is_fork_parent and not worker.result.ends for worker in workers._workers)
            )
            assert spared[-1] == needed[-1]
        start(workers, task)

    monkeypatch.setattr(TokenPool, "take", taken)
    monkeypatch.setattr(Workers, "_start", started)
    folder = write_project(tmp_path, MISSION, TESTS)
    path = run_campaign(request_for(folder, engine="fork", rounds=3, jobs=jobs), Quiet())
    assert len(needed) == 3
    with JournalReader.open(path) as journal:
        assert {outcome.round for outcome in journal.outcomes()} == {0, 1, 2}
