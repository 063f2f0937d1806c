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


@pytest.mark.parametrize(("jobs", "most"), [(2, 1), (4, 2)])
def test_fork_parents_begin_while_each_has_a_token_to_fork_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, jobs: int, most: int
) -> None:
    beginning: list[int] = []
    start = Workers._start

    def started(workers: Workers, task: Any) -> None:
        start(workers, task)
        if task.is_fork_parent:
            parents = [one for one in workers._workers if one.task.is_fork_parent]
            beginning.append(sum(not one.result.ends for one in parents))

    monkeypatch.setattr(Workers, "_start", started)
    folder = write_project(tmp_path, MISSION, TESTS)
    path = run_campaign(request_for(folder, engine="fork", rounds=3, jobs=jobs), Quiet())
    assert len(beginning) == 3
    assert max(beginning) <= most
    with JournalReader.open(path) as journal:
        assert {one.round for one in journal.outcomes()} == {0, 1, 2}
