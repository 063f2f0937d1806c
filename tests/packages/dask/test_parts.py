"""A fork parent in parts comes to what it comes to as one: each mutant is in exactly one part."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from mutabot.execution.workers import Workers
from tests.campaign.project import Quiet, request_for, run_campaign
from tests.packages.dask.clusters import ends, write


@pytest.mark.whole
def test_parts_find_what_one_fork_parent_finds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    project = write(tmp_path)
    request = request_for(project, engine="fork", rounds=2)
    whole = ends(run_campaign(request, Quiet()))
    fork_parents: list[tuple[int, tuple[str, ...], tuple[str, ...]]] = []
    events = Workers.events

    def noted(self: Workers, tasks):  # type: ignore[no-untyped-def]
        def passed():  # type: ignore[no-untyped-def]
            for task in tasks:
                if task.job.forking is not None:
                    mutants = tuple(mutant.id for mutant in task.job.forking.mutants)
                    fork_parents.append((task.job.round, mutants, task.job.tests))
                yield task

        return events(self, passed())

    monkeypatch.setattr(Workers, "events", noted)
    monkeypatch.setattr(Workers, "spread", 4)
    project.joinpath(".mutabot", "journal.sqlite").unlink()
    assert ends(run_campaign(request, Quiet())) == whole
    assert Counter(round for round, _, _ in fork_parents).keys() == {0, 1}
    assert len(fork_parents) > 2
    counts = Counter((round, mutant) for round, mutants, _ in fork_parents for mutant in mutants)
    assert set(counts.values()) == {1}
