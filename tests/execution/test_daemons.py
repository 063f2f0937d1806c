"""A daemon, in a session of its own and with an empty environment, ends with its worker, and is told."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from tests.campaign.project import REPLAY, Quiet, outcomes, request_for, write_project

#: it says who it is, again and again
DAEMON = """
import os, sys, time
while True:
    with open(sys.argv[1], "a") as file:
        print(os.getpid(), file=file)
    time.sleep(0.05)
"""
#: as daemons are started, so that nothing leads back to who started them
START = """
    import os, sys, time

    def size(file):
        return os.path.getsize(file) if os.path.exists(file) else 0

    def start_daemon(file={file!r}, code={code!r}):
        before = size(file)
        if os.fork():
            os.wait()
            while size(file) == before:
                time.sleep(0.01)
            return
        os.setsid()
        if os.fork():
            os._exit(0)
        os.chdir("/")
        os.closerange(0, 1000)
        os.execve(sys.executable, [sys.executable, "-c", code, file], {{}})
    """
MISSION = """
    from daemons import start_daemon

    def run(arm):
        arm.move_by(0.5)
        if arm.x != 0.5:
            start_daemon()
    """
TESTS = """
    from mission import run
    from robot import Arm

    def test_run():
        arm = Arm()
        run(arm)
        assert arm.x == 0.5
    """
TEST_HANGS = """
    import time
    from daemons import start_daemon

    def test_run():
        start_daemon()
        time.sleep(600)
    """


@pytest.fixture
def heartbeat() -> Iterator[Path]:
    """A file that no run keeps to itself."""
    path = Path(f"/var/tmp/mutabot-heartbeat-{os.getpid()}")
    path.unlink(missing_ok=True)
    yield path
    for pid in pids_in(path):
        if is_daemon(pid):
            os.kill(pid, signal.SIGKILL)
    path.unlink(missing_ok=True)


def pids_in(path: Path) -> set[int]:
    return {int(line) for line in path.read_text("ascii").split()} if path.exists() else set()


def is_daemon(pid: int) -> bool:
    try:
        return b"print(os.getpid(), file=file)" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False


def project(folder: Path, mission: str, tests: str, heartbeat: Path) -> Path:
    start = START.format(file=str(heartbeat), code=DAEMON)
    return write_project(folder, mission, tests, more={"daemons.py": start})


@pytest.mark.parametrize("engine", [REPLAY, pytest.param("auto", marks=pytest.mark.whole)])
def test_a_daemon_that_a_mutant_starts_is_gone_and_reported(
    engine: str, tmp_path: Path, heartbeat: Path
) -> None:
    # the original starts one as well where its runs are copies of one process
    mission = MISSION.replace("if arm.x", "if True or arm.x") if engine == "auto" else MISSION
    folder = project(tmp_path, mission, TESTS, heartbeat)
    progress = Quiet()
    request = request_for(folder, engine=engine, rounds=1, only=("reverse", "skip"))
    found = outcomes(run_campaign(request, progress))
    assert engine == "auto" or {outcome.engine for outcome in found} == {engine}
    check_gone(heartbeat)
    told = [line for line in progress.lines if "leave processes running" in line]
    assert len(told) == 1
    assert any(f"({pid})" in told[0] for pid in pids_in(heartbeat)), told


def check_gone(heartbeat: Path) -> None:
    pids = pids_in(heartbeat)
    assert pids, "no daemon was there"
    assert not any(map(is_daemon, pids))


@pytest.mark.whole
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_controller_that_is_ended_leaves_none(tmp_path: Path, heartbeat: Path, number: int) -> None:
    folder = project(tmp_path, MISSION, TEST_HANGS, heartbeat)
    controller = subprocess.Popen([sys.executable, "-m", "mutabot", "run"], cwd=folder)
    try:
        wait_until(heartbeat.exists)
        controller.send_signal(number)
        controller.wait()
        wait_until(lambda: not any(map(is_daemon, pids_in(heartbeat))))
    finally:
        controller.kill()
        controller.wait()


def test_a_test_that_ends_its_parent_ends_itself(tmp_path: Path, heartbeat: Path) -> None:
    code = "import os, signal, time; os.kill(os.getppid(), signal.SIGKILL); time.sleep(600)"
    tests = TESTS.replace("arm = Arm()", f"exec({code!r})")
    folder = project(tmp_path, MISSION, tests, heartbeat)
    ended = subprocess.run(
        [sys.executable, "-m", "mutabot", "run"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 3, ended.stdout + ended.stderr
    assert "killed by signal 9" in ended.stdout + ended.stderr


@pytest.mark.whole
def test_the_tests_see_no_orphans_of_theirs(tmp_path: Path, heartbeat: Path) -> None:
    """What they wait for are their own children, and a daemon that has ended is gone at once."""
    tests = """
        import os, subprocess, sys, time, pytest
        from mission import run
        from robot import Arm

        def test_run():
            code = "import os; os.fork() or os.setsid() or print(os.getpid(), flush=True) or os._exit(0)"
            out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
            with pytest.raises(ChildProcessError):
                os.waitpid(-1, os.WNOHANG)
            while os.path.exists(f"/proc/{int(out.stdout)}"):
                time.sleep(0.01)
            child = os.fork()
            if not child:
                os._exit(7)
            assert os.waitstatus_to_exitcode(os.wait()[1]) == 7
            assert os.getpid() == os.getpgrp() == os.getsid(0)
            arm = Arm()
            run(arm)
            assert arm.x == 0.5
        """
    folder = project(tmp_path, MISSION.replace("start_daemon()", "pass"), tests, heartbeat)
    found = outcomes(run_campaign(request_for(folder, engine="replay", rounds=1), Quiet()))
    assert {outcome.verdict.value for outcome in found} == {"killed"}


def wait_until(is_so: object) -> None:
    until = time.monotonic() + 120
    while not is_so():  # type: ignore[operator]
        assert time.monotonic() < until
        time.sleep(0.05)
