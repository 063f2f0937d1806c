"""A mutant that only waits lends its place: others run meanwhile, unless there is but one place."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.execution import workers as waiting
from mutabot.execution.workers import Waiting, Workers
from mutabot.model import Verdict, process_time
from mutabot.model.event_file import VARIABLE
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
SLEEP = "import time; time.sleep(600)"
#: a node that looks for messages now and then
POLL = "import time\nwhile True: time.sleep(0.2)"
LOOP = "while True: pass"
#: a node below it does the work
BELOW = "import subprocess, sys; subprocess.run([sys.executable, '-c', {!r}])"
#: seconds between two looks here
PERIOD = 0.25
#: seconds after which nothing more is expected
PATIENCE = 120.0


@dataclass
class Process:
    """A worker to look at."""

    pid: int
    processes: Path


@contextmanager
def running(*codes: str, on: int | None = None, mark: Path | None = None) -> Iterator[list[int]]:
    """Processes that run these programs, on one processor if that is named, known by ``mark`` alone."""
    environment = None if mark is None else {VARIABLE: str(mark)}
    processes = []
    try:
        for code in codes:
            command = [sys.executable, "-c", code]
            processes.append(subprocess.Popen(command, env=environment, start_new_session=True))
            if on is not None:
                os.sched_setaffinity(processes[-1].pid, {on})
        yield [process.pid for process in processes]
    finally:
        below = process_time.below([process.pid for process in processes], process_time.children())
        for pid in below:
            os.kill(pid, 9)
        for process in processes:
            process.wait()


def is_lent(workers: list[Process], seconds: float) -> bool:
    """Whether one of two places is lent within so many seconds."""
    places = Waiting(2)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if places.has_place(workers):
            return True
        time.sleep(PERIOD / 4)
    return False


@pytest.fixture
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(waiting, "PERIOD", PERIOD)


@pytest.fixture
def _roomy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever else this machine does is none of a test's business."""
    monkeypatch.setattr(waiting, "shortage", lambda: 0.0)


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many workers there were whenever one had begun."""
    counts: list[int] = []
    start: Callable[..., Any] = Workers._start

    def counted(workers: Workers, *arguments: Any) -> None:
        start(workers, *arguments)
        counts.append(len(workers._workers))

    monkeypatch.setattr(Workers, "_start", counted)
    return counts


@pytest.mark.whole
@pytest.mark.usefixtures("_roomy")
def test_mutants_that_only_wait_leave_their_places_to_others(tmp_path: Path, begun: list[int]) -> None:
    limits = "timeout_seconds = 20\ntimeout_factor = 1000.0\n"
    project = write_project(tmp_path, MISSION, TESTS, configuration=CONFIGURATION + limits)
    request = request_for(project, engine="replay", jobs=2, rounds=1, only=("reverse", "skip"))
    found = outcomes(run_campaign(request, Quiet()))
    assert [one.verdict for one in found] == [Verdict.TIMEOUT] * 6
    assert max(begun) > request.jobs


@pytest.mark.whole
@pytest.mark.whole
def test_beside_busy_programs_no_more_begin_than_there_are_places(tmp_path: Path, begun: list[int]) -> None:
    limits = "timeout_seconds = 6\ntimeout_factor = 1000.0\n"
    project = write_project(tmp_path, MISSION, TESTS, configuration=CONFIGURATION + limits)
    request = request_for(project, jobs=2, rounds=1, only=("reverse",))
    with running(*[LOOP] * 24):
        run_campaign(request, Quiet())
    assert begun
    assert max(begun) <= request.jobs


@pytest.mark.usefixtures("_quick")
def test_where_one_runs_at_a_time_it_is_one(tmp_path: Path) -> None:
    places = Waiting(1)
    assert places.has_place([])
    end = time.monotonic() + 6 * PERIOD
    while time.monotonic() < end:
        assert not places.has_place([Process(os.getpid(), tmp_path)])
        time.sleep(PERIOD / 2)


@pytest.mark.whole
@pytest.mark.parametrize(("code", "waits"), [(SLEEP, True), (POLL, True), (LOOP, False)])
@pytest.mark.parametrize("where", ["itself", "below", "elsewhere"])
@pytest.mark.usefixtures("_quick", "_roomy")
def test_what_a_worker_and_those_below_it_ask_for_counts(
    tmp_path: Path, code: str, where: str, waits: bool
) -> None:
    own = {"itself": code, "below": BELOW.format(code), "elsewhere": SLEEP}[where]
    elsewhere = [code] if where == "elsewhere" else []
    with running(own, LOOP) as (worker, other), running(*elsewhere, mark=tmp_path):
        both = [Process(worker, tmp_path), Process(other, tmp_path / "none")]
        assert is_lent(both, PATIENCE if waits else 12 * PERIOD) is waits


@pytest.mark.whole
@pytest.mark.usefixtures("_quick", "_roomy")
def test_a_worker_that_gets_no_processor_does_not_wait(tmp_path: Path) -> None:
    processor = min(os.sched_getaffinity(0))
    with running(LOOP, LOOP, *[LOOP] * 8, on=processor) as (one, two, *_):
        before = process_time.accounts_of([one])
        assert not is_lent([Process(one, tmp_path), Process(two, tmp_path / "none")], 20 * PERIOD)
        after = process_time.accounts_of([one])
    assert before is not None
    assert after is not None
    ran = after[one].ran - before[one].ran
    assert ran < 0.25 * (ran + after[one].queued - before[one].queued)  # it got what one that polls may take


@pytest.mark.whole
@pytest.mark.usefixtures("_quick")
def test_nothing_is_lent_while_processors_are_short(tmp_path: Path) -> None:
    with running(SLEEP, SLEEP, *[LOOP] * 3 * (os.cpu_count() or 1)) as (one, two, *_):
        assert not is_lent([Process(one, tmp_path), Process(two, tmp_path / "none")], 20 * PERIOD)


@pytest.mark.parametrize("is_crowded", [False, True])
@pytest.mark.usefixtures("_quick")
def test_a_kernel_without_pressure_is_asked_for_its_load(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_crowded: bool
) -> None:
    monkeypatch.setattr(waiting, "shortage", lambda: None)
    monkeypatch.setattr(waiting, "is_crowded", lambda: is_crowded)
    with running(SLEEP, SLEEP) as (one, two):
        both = [Process(one, tmp_path), Process(two, tmp_path / "none")]
        assert is_lent(both, 12 * PERIOD if is_crowded else PATIENCE) is not is_crowded


@pytest.mark.usefixtures("_quick", "_roomy")
def test_nothing_is_lent_where_the_kernel_keeps_no_accounts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(waiting, "accounts_of", lambda processes: None)
    with running(SLEEP, SLEEP) as (one, two):
        assert not is_lent([Process(one, tmp_path), Process(two, tmp_path / "none")], 12 * PERIOD)


def test_what_the_kernel_tells_of_the_load() -> None:
    assert process_time.accounts_of([os.getpid()])
    process_time.is_crowded()
    total = process_time.shortage()
    assert total is None or total >= 0.0
