"""A mutant that only waits lends its place: others run meanwhile, unless there is but one place."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from mutabot.border.processes import VARIABLE
from mutabot.campaign.run import run_campaign
from mutabot.campaign.workers import waiting
from mutabot.campaign.workers.waiting import Waiting
from mutabot.model import Verdict
from tests.campaign.project import CONFIGURATION, Quiet, outcomes, request_for, write_project

#: each of its moves is waited for; a mutated one never comes, and nothing is done meanwhile
MISSION = """
    import time

    def run(arm):
        arm.move_by(0.1)
        wait_for(arm, 0.1)
        arm.move_by(0.2)
        wait_for(arm, 0.3)
        arm.move_by(0.3)
        wait_for(arm, 0.6)

    def wait_for(arm, x):
        while abs(arm.x - x) > 1e-9:
            time.sleep(0.05)
    """
#: it starts a process, so that none of its mutants is a branch
TESTS = """
    import subprocess, sys
    from mission import run
    from robot import Arm

    def test_run():
        subprocess.run([sys.executable, "-c", "pass"], check=True)
        run(Arm())
    """
SLEEP = "import time; time.sleep(60)"
#: seconds between two looks here: the kernel counts in hundredths
PERIOD = 0.2


@dataclass
class Process:
    """A worker to look at."""

    pid: int
    processes: Path


@dataclass
class Timed(Quiet):
    """A progress that notes when it is told of each step."""

    ends: list[float] = field(default_factory=list)

    def advance(self, line: str | None = None) -> None:
        self.ends.append(time.monotonic())
        super().advance(line)


@pytest.mark.whole
def test_mutants_that_only_wait_leave_their_places_to_others(tmp_path: Path) -> None:
    limits = "timeout_seconds = 6\ntimeout_factor = 1000.0\n"
    project = write_project(tmp_path, MISSION, TESTS, configuration=CONFIGURATION + limits)
    request = request_for(project, jobs=2, rounds=1, only=("reverse", "skip"))
    progress = Timed()
    found = outcomes(run_campaign(request, progress))
    assert [one.verdict for one in found] == [Verdict.TIMEOUT] * 6
    spans = [(end - one.wall, end) for end, one in zip(progress.ends[-6:], found, strict=True)]
    at_once = (sum(start <= begin < end for start, end in spans) for begin, _ in spans)
    assert max(at_once) > request.jobs


@pytest.fixture
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(waiting, "PERIOD", PERIOD)


@pytest.mark.usefixtures("_quick")
def test_where_one_runs_at_a_time_it_is_one(tmp_path: Path) -> None:
    places = Waiting(1)
    assert places.has_place([])
    end = time.monotonic() + 6 * PERIOD
    while time.monotonic() < end:
        assert not places.has_place([Process(os.getpid(), tmp_path)])
        time.sleep(PERIOD / 2)


@pytest.mark.parametrize(("code", "waits"), [(SLEEP, True), ("while True: pass", False)])
@pytest.mark.parametrize("is_below", [False, True])
@pytest.mark.usefixtures("_quick")
def test_what_works_below_a_worker_counts(tmp_path: Path, code: str, waits: bool, is_below: bool) -> None:
    worker = subprocess.Popen([sys.executable, "-c", SLEEP])
    mark = {VARIABLE: str(tmp_path)} if is_below else {}
    other = subprocess.Popen([sys.executable, "-c", code], env=mark, start_new_session=True)
    try:
        places = Waiting(2)
        both = [
            Process(worker.pid if is_below else other.pid, tmp_path),
            Process(other.pid, tmp_path / "none"),
        ]
        end = time.monotonic() + 10 * PERIOD
        has_place = False
        while not has_place and time.monotonic() < end:
            has_place = places.has_place(both)
            time.sleep(PERIOD / 2)
    finally:
        worker.kill()
        other.kill()
        worker.wait()
        other.wait()
    assert has_place is waits
