"""A fork has the process id of its parent, and its clock leaves out what the parent has waited."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from suites.corpus import PROJECTS, copied

PRIVILEGED = pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a fork the id of its parent")
#: as an ordinary user: without any right, in a user namespace
ORDINARY = ["unshare", "--user", "--map-user=1000", "--map-group=1000"]

FORKED = """
import os, subprocess
from mutabot.runtime.isolation.namespaces import end_first, fork

reading, writing = os.pipe()
me = os.getpid()
pids = fork()
if pids is None:
    left = subprocess.Popen(["sleep", "60"])
    os.write(writing, repr((os.getpid() == me, left.pid > 1)).encode())
    os._exit(7)
os.close(writing)
print(os.read(reading, 99).decode())
print(os.waitstatus_to_exitcode(os.wait()[1]))
try:
    os.wait()
except ChildProcessError:
    print("no other child")
print("held" if os.path.exists(f"/proc/{pids.first}") else "gone")
end_first(pids.first)
print("gone" if not os.path.exists(f"/proc/{pids.first}") else "there")
"""

CLOCK = """
import os, subprocess, sys, time
from mutabot.runtime.isolation.namespaces import leave_out, left_out

def behind():
    passed = time.monotonic() - began
    return time.time() - wall - passed


began, wall = time.monotonic(), time.time()
time.sleep(0.3)
leave_out(time.monotonic() - began)
print(0.2 < behind() < 50.0)
leave_out(100.0)
print(100.2 < behind() < 150.0, 100.2 < left_out() < 150.0)
told = subprocess.run([sys.executable, "-c", "import time; print(time.monotonic())"], capture_output=True)
print(abs(float(told.stdout) - time.monotonic()) < 50.0)
"""


def said_by(script: str) -> list[str]:
    done = subprocess.run(
        [sys.executable, "-c", script], check=False, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@PRIVILEGED
def test_a_fork_has_the_id_of_its_parent_and_all_that_it_leaves_ends() -> None:
    assert said_by(FORKED) == ["(True, True)", "7", "no other child", "held", "gone"]


@PRIVILEGED
def test_the_clock_leaves_out_what_passed() -> None:
    assert said_by(CLOCK) == ["True", "True True", "True"]


@pytest.mark.whole
@pytest.mark.skipif(
    subprocess.run([*ORDINARY, "true"], check=False, capture_output=True).returncode != 0,
    reason="no user namespaces here",
)
@pytest.mark.parametrize(
    ("project", "engine"), [("deadline_over_the_call", "fork"), ("process_id_checked", "replay")]
)
def test_an_ordinary_user_forks_what_does_not_ask_for_its_id(
    project: str, engine: str, tmp_path: Path
) -> None:
    """Nobody but root can give a fork its parent's id: such a program runs in processes of its own."""
    folder = copied(PROJECTS / project, tmp_path / project)
    command = [*ORDINARY, sys.executable, "-m", "mutabot", "-C", str(folder), "run", "--json", "-j", "1"]
    done = subprocess.run(
        [*command, "--sample", "4"], check=False, capture_output=True, text=True, timeout=120
    )
    found = [end for mutant in json.loads(done.stdout)["mutants"] for end in mutant["rounds"]]
    assert {end["engine"] for end in found} == {engine}, done.stderr
    assert {end["verdict"] for end in found} <= {"killed", "survived"}
    assert ("asks for the process id" in done.stderr) == (engine == "replay")
