"""A pause: nothing new begins, what is at work ends, and no verdict is another one."""

from __future__ import annotations

import os
import select
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from campaign.project import Quiet, outcomes, request_for, write_project
from mutabot.campaign.engines import trunk
from mutabot.campaign.run import run_campaign
from mutabot.campaign.workers.pause import Pause

MISSION = """
    def run(arm):
        arm.move_by(0.25)
        arm.move_by(-0.5)
        return arm.position()
"""
TESTS = """
    import time
    import mission
    from robot import Arm

    def test_it_is_where_it_should_be():
        arm = Arm()
        mission.run(arm)
        time.sleep(0.05)
        assert arm.x == -0.25
"""


@dataclass
class Pausing(Quiet):
    """A progress that pauses at the second outcome, and sees what comes while it lasts."""

    pause: Pause | None = None
    seconds: float = 0.0
    outcomes: int = 0
    meanwhile: list[int] = field(default_factory=list)
    _is_mutants: bool = False
    _watcher: threading.Thread | None = None

    def stage(self, text: str, total: int | None = None) -> None:
        super().stage(text, total)
        self._is_mutants = text == "mutants"

    def advance(self, line: str | None = None) -> None:
        super().advance(line)
        self.outcomes += self._is_mutants
        if self.pause is not None and self.outcomes == 2 and self._watcher is None:
            self.pause.begin()
            self._watcher = threading.Thread(target=self._watch, args=(self.pause,))
            self._watcher.start()

    def _watch(self, pause: Pause) -> None:
        time.sleep(self.seconds / 2)  # what is at work ends
        self.meanwhile.append(self.outcomes)
        time.sleep(self.seconds / 2)
        self.meanwhile.append(self.outcomes)
        pause.end()

    def join(self) -> None:
        assert self._watcher is not None
        self._watcher.join()


def ends(path: Path) -> dict[tuple[str, int], tuple[object, ...]]:
    return {
        (one.mutant, one.round): (one.verdict, one.by, one.test, one.message, one.engine)
        for one in outcomes(path)
    }


@pytest.mark.parametrize("engine", ["branch", "replay"])
def test_a_paused_campaign_ends_like_one_that_is_not(
    engine: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trunk, "_PATIENCE", 1.0)  # less than the pause: the safety net must not take note
    options: dict[str, Any] = {"engine": engine, "jobs": 1, "rounds": 1, "only": ("1-5",)}
    folder = write_project(tmp_path / "project", MISSION, TESTS)
    usual = ends(run_campaign(request_for(folder, **options), Quiet()))
    with Pause() as pause:
        progress = Pausing(pause=pause, seconds=4.0)
        path = run_campaign(request_for(folder, fresh=True, pause=pause, **options), progress)
        progress.join()
    assert ends(path) == usual
    first, last = progress.meanwhile
    assert first == last < len(usual)
    assert not [line for line in progress.lines if "died" in line]


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
        assert frozen <= pause.clock() < frozen + 0.05 + (time.monotonic() - pause.lasted_until())


def test_nothing_is_paused_at_first_and_a_pause_is_seen_from_outside() -> None:
    with Pause() as pause:
        other = os.dup(pause.reading)
        assert select.select([other], [], [], 0)[0] == [other]
        pause.begin()
        assert select.select([other], [], [], 0)[0] == []
        pause.end()
        assert select.select([other], [], [], 0)[0] == [other]
        os.close(other)
