"""When a campaign is over nothing is left that its tests started, however it was started and ended."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.execution.cleanup import end_abandoned, end_left_over
from mutabot.model import Verdict
from mutabot.model.event_file import VARIABLE
from tests.campaign.project import Quiet, outcomes, request_for, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.5)
    """
#: each test leaves a process in a session of its own, and its number in a file; the last kills its worker
TESTS = """
    import os, pathlib, signal, subprocess, sys
    from mission import run
    from robot import Arm

    def leave(code):
        process = subprocess.Popen([sys.executable, "-c", code], start_new_session=True)
        with open({numbers!r}, "a") as file:
            print(process.pid, file=file)

    def test_run():
        leave("import time; time.sleep(600)")
        leave("import os, time; os.fork() or os.setsid() or time.sleep(600); time.sleep(600)")
        arm = Arm()
        run(arm)
        if arm.x != 0.5:
            os.kill(os.getpid(), signal.SIGKILL)
    """


def is_alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text("ascii").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state not in "ZX"


@pytest.mark.whole
def test_nothing_is_left(tmp_path: Path) -> None:
    numbers = Path("/var/tmp", tmp_path.name + str(os.getpid()))  # workers see no others' changes in /tmp
    tests = TESTS.format(numbers=str(numbers))
    project = write_project(tmp_path / "project", MISSION, tests)
    found = outcomes(run_campaign(request_for(project, engine="replay", rounds=1), Quiet()))
    pids = [int(line) for line in numbers.read_text("ascii").splitlines()]
    numbers.unlink()
    # the worker was killed: nobody in it cleared up
    assert any(outcome.verdict is Verdict.ERROR for outcome in found), [
        (outcome.verdict, outcome.message) for outcome in found
    ]
    assert len(pids) > 4
    assert not any(map(is_alive, pids))


def test_only_what_carries_the_mark_is_ended(tmp_path: Path) -> None:
    def sleeper(mark: str) -> subprocess.Popen[bytes]:
        return subprocess.Popen(["sleep", "600"], env={**os.environ, VARIABLE: mark}, start_new_session=True)

    here, there = sleeper(str(tmp_path / "a")), sleeper(str(tmp_path / "ab"))
    try:
        assert end_left_over(tmp_path / "a") == [f"sleep 600 ({here.pid})"]
        assert here.wait(10) == -signal.SIGKILL
        assert end_left_over(tmp_path / "a") == []
        assert there.poll() is None
    finally:
        there.kill()
        there.wait()


def test_what_a_killed_controller_has_left_ends_with_the_next_campaign(tmp_path: Path) -> None:
    def workers_of(controller: subprocess.Popen[bytes], name: str) -> Path:
        folder = tmp_path / name
        folder.mkdir()
        began = Path(f"/proc/{controller.pid}/stat").read_text("ascii").rpartition(")")[2].split()[19]
        (folder / "controller").write_text(f"{controller.pid} {began}", "ascii")
        return folder

    def node(folder: Path) -> subprocess.Popen[bytes]:
        mark = str(folder / "home" / "processes")
        return subprocess.Popen(["sleep", "600"], env={**os.environ, VARIABLE: mark}, start_new_session=True)

    killed, alive = subprocess.Popen(["sleep", "600"]), subprocess.Popen(["sleep", "600"])
    left, needed = node(workers_of(killed, "work-a")), node(workers_of(alive, "work-b"))
    try:
        killed.kill()
        killed.wait()
        assert end_abandoned(tmp_path) == 1
        assert left.wait(10) == -signal.SIGKILL
        assert needed.poll() is None
        assert end_abandoned(tmp_path) == 0
    finally:
        for process in (alive, needed):
            process.kill()
            process.wait()


def test_looking_takes_next_to_nothing(tmp_path: Path) -> None:
    began = time.process_time()
    for _ in range(10):
        end_left_over(tmp_path)
    assert time.process_time() - began < 1.0, sys.platform
