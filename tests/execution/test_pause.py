"""A pause: nothing new begins, what is at work ends, and no verdict is another one."""

from __future__ import annotations

import os
import select
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

import pytest

from campaign.project import Quiet, outcomes, request_for, write_project
from mutabot.campaign.engines import fork_parent
from mutabot.campaign.run import run_campaign
from mutabot.execution.interruption import Pause

MISSION = """
    def run(arm):
        arm.move_by(0.25)
        arm.move_by(-0.5)
        return arm.position()
"""
TESTS = """
    import os
    import time
    import mission
    from robot import Arm

    def test_it_is_where_it_should_be():
        arm = Arm()
        mission.run(arm)
        written = os.open({log!r}, os.O_WRONLY | os.O_APPEND)
        os.write(written, b"+")
        os.close(written)
        time.sleep(0.3)
        assert arm.x == -0.25
"""
#: seconds that a pause lasts; more than a trunk may be silent
LONG, PATIENCE = 6.0, 4.0


@dataclass
class Pausing(Quiet):
    """A progress that pauses once the second mutant is at work, and counts those that run.

    Attributes:
        log: has a sign for each run of the test.
        meanwhile: how many were there in the midst of the pause, and at its end.
    """

    pause: Pause = field(default_factory=Pause)
    log: Path = Path()
    meanwhile: list[int] = field(default_factory=list)
    watcher: threading.Thread | None = None

    def stage(self, text: str, total: int | None = None) -> None:
        super().stage(text, total)
        if text == "mutants":
            self.watcher = threading.Thread(target=self._watch, args=(self._runs(),))
            self.watcher.start()

    def _runs(self) -> int:
        return self.log.stat().st_size

    def _watch(self, before: int) -> None:
        until = time.monotonic() + 60.0  # so that a failure does not hang
        while self._runs() < before + 2 and time.monotonic() < until:
            time.sleep(0.01)
        self.pause.begin()
        for _ in range(2):
            time.sleep(LONG / 2)  # in the first half, what is at work ends
            self.meanwhile.append(self._runs())
        self.pause.end()


@pytest.fixture
def log() -> Iterator[Path]:
    """A file that no process has a private copy of."""
    with NamedTemporaryFile(dir="/var/tmp", prefix="mutabot-test-") as file:
        yield Path(file.name)


def ends(path: Path) -> dict[tuple[str, int], tuple[object, ...]]:
    return {
        (one.mutant, one.round): (one.verdict, one.by, one.test, one.message, one.engine)
        for one in outcomes(path)
    }


@pytest.mark.whole
@pytest.mark.parametrize("engine", ["branch", "replay"])
def test_a_paused_campaign_ends_like_one_that_is_not(
    engine: str, tmp_path: Path, log: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options: dict[str, Any] = {"engine": engine, "jobs": 1, "rounds": 1, "only": ("1-3",)}
    folder = write_project(tmp_path / "project", MISSION, TESTS.format(log=str(log)))
    usual = ends(run_campaign(request_for(folder, **options), Quiet()))
    assert {end[-1] for end in usual.values()} == {engine}
    monkeypatch.setattr(fork_parent, "wall_limit", lambda *_: 20.0)
    monkeypatch.setattr(fork_parent, "_PATIENCE", PATIENCE - 2 * 20.0)  # to which twice that limit is added
    with Pause() as pause:
        progress = Pausing(pause=pause, log=log)
        path = run_campaign(request_for(folder, fresh=True, pause=pause, **options), progress)
        assert progress.watcher is not None
        progress.watcher.join()
        middle, last = progress.meanwhile
    assert middle == last < log.stat().st_size
    assert ends(path) == usual


def test_the_time_of_pauses_does_not_count() -> None:
    with Pause() as pause:
        assert pause.lasted_until() < time.monotonic()
        before = pause.clock()
        assert pause.begin()
        assert not pause.begin()
        frozen = pause.clock()
        time.sleep(0.05)
        assert pause.clock() == frozen >= before
        assert pause.end()
        assert not pause.end()
        assert frozen <= pause.clock() <= frozen + (time.monotonic() - pause.lasted_until())
    assert not pause.begin()  # it is over


def test_nothing_is_paused_at_first_and_a_pause_is_seen_from_outside() -> None:
    with Pause() as pause:
        other = os.dup(pause.reading)
        assert select.select([other], [], [], 0)[0] == [other]
        pause.begin()
        assert select.select([other], [], [], 0)[0] == []
        pause.end()
        assert select.select([other], [], [], 0)[0] == [other]
        os.close(other)
