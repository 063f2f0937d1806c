"""On a busy machine the wall clock says little: a mutant has its time, or is run once more alone."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.campaign.verdict import Death, Run, _ruling
from mutabot.execution.workers import Workers
from mutabot.model import Outcome, Verdict, deadline, process_time
from mutabot.model.deadline import Deadline, Limit
from mutabot.model.process_time import TimeUsed
from tests.campaign.project import CONFIGURATION, REPLAY, Quiet, outcomes, request_for, write_project

PROCESSOR = min(os.sched_getaffinity(0))
LOOP = "while True: pass"
#: what a test does with a wrong arm is in ``when_wrong``
MISSION = """
    import os, pathlib, time

    def run(arm):
        arm.move_by(0.5)
        if arm.x != 0.5:
            when_wrong()

    def compute(seconds):
        os.sched_setaffinity(0, {{ {processor} }})  # where others are as well
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            pass

    def when_wrong():
        {when_wrong}
    """
TESTS = """
    from mission import run
    from robot import Arm

    def test_run():
        run(Arm())
    """
#: seconds that a test may take
LIMIT = 4
HANG_ONCE = """
        if not pathlib.Path({flag!r}).exists():
            pathlib.Path({flag!r}).touch()
            while True:
                time.sleep(0.1)
"""


@contextmanager
def loops(count: int = 6) -> Iterator[list[int]]:
    """So many busy programs on one processor."""
    processes = [subprocess.Popen([sys.executable, "-c", LOOP]) for _ in range(count)]
    try:
        for process in processes:
            os.sched_setaffinity(process.pid, {PROCESSOR})
        yield [process.pid for process in processes]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def campaign(folder: Path, when_wrong: str, engine: str, tests: str = TESTS) -> tuple[Outcome, list[str]]:
    """How the one mutant ends, and what is told."""
    limits = f"timeout_seconds = {LIMIT}\n"
    mission = MISSION.format(processor=PROCESSOR, when_wrong=when_wrong)
    project = write_project(folder, mission, tests, configuration=CONFIGURATION + limits)
    progress = Quiet()
    (found,) = outcomes(
        run_campaign(request_for(project, engine=engine, rounds=1, only=("reverse",)), progress)
    )
    return found, progress.lines


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> list[tuple[bool, int]]:
    """Of each worker that began whether it is to be alone, and how many there were then."""
    found: list[tuple[bool, int]] = []
    start: Callable[..., Any] = Workers._start

    def noted(self: Workers, task: Any) -> None:
        start(self, task)
        found.append((task.alone, len(self._workers)))

    monkeypatch.setattr(Workers, "_start", noted)
    return found


@pytest.fixture
def flag() -> Iterator[Path]:
    """A file that no run keeps to itself."""
    path = Path(f"/var/tmp/mutabot-flag-{os.getpid()}")
    path.unlink(missing_ok=True)
    yield path
    path.unlink(missing_ok=True)


ENGINES = ["fork", REPLAY]


@pytest.mark.whole
@pytest.mark.parametrize("engine", ENGINES)
def test_a_mutant_that_is_kept_from_the_processor_gets_its_time(engine: str, tmp_path: Path) -> None:
    with loops():
        found, _ = campaign(tmp_path, f"compute({LIMIT + 1})", engine)
    assert (found.verdict, found.engine, found.message) == (Verdict.SURVIVED, engine, None)
    assert found.wall > LIMIT


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    "limit",
    [
        "no end after 4 s of wall clock",
        pytest.param("Timeout (>3.0s) from pytest-timeout", marks=pytest.mark.whole),
    ],
)
def test_what_the_clock_ends_on_a_busy_machine_is_run_alone(
    engine: str, limit: str, tmp_path: Path, flag: Path, begun: list[tuple[bool, int]]
) -> None:
    tests = TESTS
    if "pytest-timeout" in limit:
        pytest.importorskip("pytest_timeout")
        tests = TESTS.replace("    def test", "    @pytest.mark.timeout(3)\n    def test").replace(
            "    from m", "    import pytest\n    from m"
        )
    with loops():
        found, lines = campaign(tmp_path, HANG_ONCE.format(flag=str(flag)).strip(), engine, tests)
    assert flag.exists()
    assert (found.verdict, found.engine) == (Verdict.SURVIVED, "replay")
    assert found.beside is not None
    assert limit in found.beside
    assert [count for is_alone, count in begun if is_alone] == [1]
    assert any(line.endswith("1 of 1 changed") for line in lines), lines


@pytest.mark.whole
def test_on_a_quiet_machine_a_time_out_is_one(
    tmp_path: Path, begun: list[tuple[bool, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(TimeUsed, "hindrance", lambda *arguments: None)
    found, _ = campaign(tmp_path, "while True: time.sleep(0.1)", "replay")
    assert (found.verdict, found.beside) == (Verdict.TIMEOUT, None)
    assert not any(is_alone for is_alone, _ in begun)


@pytest.mark.whole
def test_a_mutant_that_never_gets_its_time_is_no_time_out(
    tmp_path: Path, begun: list[tuple[bool, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process_time, "MOST", 1.2)
    monkeypatch.setattr(deadline, "MOST", 1.2)
    with loops(16):
        found, _ = campaign(tmp_path, "compute(1000)", "replay")
    assert found.verdict is Verdict.UNSTABLE
    assert found.message is not None
    assert "of which it had too little" in found.message
    assert [count for is_alone, count in begun if is_alone] == [1]


def test_who_had_too_little_time_is_not_judged() -> None:
    mutant: Any = None
    death = Death("no end", "test", overdue=True, acted=True, hindered="why", is_starved=True)
    assert _ruling(Run(mutant, 0, ("test",), death=death), 0)[0] is Verdict.UNSTABLE
    death.is_starved = False
    assert _ruling(Run(mutant, 0, ("test",), death=death), 0)[0] is Verdict.TIMEOUT


@pytest.mark.whole
def test_time_in_the_queue_is_not_used() -> None:
    with loops(10) as (process, *_):
        used = TimeUsed.from_now([process])
        while (used.remaining(1e9, 1.0, [process])[1] or 0.0) > 0:  # until it has run for that long
            pass
        passed = process_time.monotonic() - used.began
        assert passed > 2.0
        assert used.hindrance([process]) is not None
        assert used.remaining(2 * passed, None, [process])[0] > 0
        assert used.remaining(passed / process_time.MOST, None, [process])[0] <= 0  # whatever it had


def test_time_asleep_is_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process_time, "MOST", 1e9)  # whatever else would end the loop
    process = subprocess.Popen(["sleep", "600"])
    try:
        used = TimeUsed.from_now([process.pid])
        while used.remaining(0.5, None, [process.pid])[0] > 0:
            pass
        assert process_time.monotonic() - used.began >= 0.5
    finally:
        process.kill()
        process.wait()


class Clock:
    """A machine of which a test says what a process has had."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = self.ran = self.queued = 0.0
        for module in (deadline, process_time):
            monkeypatch.setattr(module, "monotonic", lambda: self.now)
        monkeypatch.setattr(process_time, "shortage", lambda: 0.0)
        monkeypatch.setattr(process_time, "descendants", set)
        monkeypatch.setattr(process_time, "accounts_of", self.accounts)

    def accounts(self, processes: Iterable[int]) -> dict[int, process_time.Account]:
        return {process: process_time.Account(self.ran, self.queued) for process in processes}

    def passes(self, seconds: float, *, ran: float = 0.0, queued: float = 0.0) -> None:
        self.now, self.ran, self.queued = self.now + seconds, self.ran + ran, self.queued + queued


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    return Clock(monkeypatch)


LIMITS = Limit(wall=60.0, processor=5.0)


def test_what_computes_is_ended_by_its_processor_time_however_busy_the_machine(clock: Clock) -> None:
    time = Deadline(LIMITS, is_counted=True)
    clock.passes(20, ran=4.9, queued=15)
    assert not time.is_over(1)
    clock.passes(1, ran=0.2, queued=0.8)
    assert time.is_over(1)
    assert time.overdue("t") == "no end after 5 s of processor time"
    assert (time.hindered, time.is_starved) == (None, False)  # it had its time: to repeat it tells nothing


def test_what_waits_is_ended_by_the_clock_on_the_wall(clock: Clock) -> None:
    time = Deadline(LIMITS, is_counted=True)
    clock.passes(59, ran=0.1)
    assert not time.is_over(1)
    clock.passes(2)
    assert time.is_over(1)
    assert time.overdue("t") == "no end after 60 s of wall clock"
    assert time.hindered is None


def test_what_computes_is_not_ended_by_the_wall_clock_though_a_host_took_its_time(clock: Clock) -> None:
    time = Deadline(Limit(wall=4.0, processor=4.0), is_counted=True)
    clock.passes(4.1, ran=3.0)
    assert not time.is_over(1)
    clock.passes(1.5, ran=1.1)
    assert time.is_over(1)
    assert time.overdue("t") == "no end after 4 s of processor time"


def test_what_computed_and_then_waits_is_ended_after_twice_the_wall_clock(clock: Clock) -> None:
    time = Deadline(Limit(wall=4.0, processor=4.0), is_counted=True)
    clock.passes(4.1, ran=3.0)
    assert not time.is_over(1)
    clock.passes(4)
    assert time.is_over(1)
    assert time.overdue("t") == "no end after 4 s of wall clock"


def test_what_waits_for_a_processor_gets_its_time(clock: Clock) -> None:
    time = Deadline(LIMITS, is_counted=True)
    clock.passes(100, ran=0.1, queued=50)
    assert not time.is_over(1)
    clock.passes(11)
    assert time.is_over(1)
    assert "stood in the queue" in (time.hindered or "")


def test_what_a_process_had_before_the_first_look_does_not_count(clock: Clock) -> None:
    clock.passes(100, ran=90)  # tests before this one
    time = Deadline(LIMITS)
    assert time.until <= clock.now + 1
    clock.passes(1, ran=1)
    assert not time.is_over(1)
    clock.passes(4.5, ran=4.5)
    assert not time.is_over(1)
    clock.passes(1, ran=1)
    assert time.is_over(1)


def test_where_the_kernel_keeps_no_accounts_the_clock_on_the_wall_ends_all(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process_time, "accounts_of", lambda processes: None)
    time = Deadline(LIMITS, is_counted=True)
    clock.passes(30)
    assert not time.is_over(1)
    clock.passes(31)
    assert time.is_over(1)


@pytest.mark.parametrize("lists", [True, False])
def test_processes_below_are_found_whether_or_not_the_kernel_lists_children(
    lists: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process_time, "_are_listed", lambda: lists)
    code = "import subprocess, sys; subprocess.run([sys.executable, '-c', 'print(1, flush=True); input()'])"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()  # the inner one runs
        found = process_time.descendants([process.pid])
        process.communicate("\n")
    assert process.pid in found
    assert len(found) == 2
