"""A fork has the process id of its parent, and its clock leaves out what the parent has waited."""

import os
import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(os.geteuid() != 0, reason="an ordinary user needs a user namespace")

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

began = time.monotonic()
time.sleep(0.3)
leave_out(time.monotonic() - began)
print(time.monotonic() - began < 0.2)
leave_out(100.0)
print(-101.0 < time.monotonic() - began < -99.0, 100.2 < left_out() < 101.0)
told = subprocess.run([sys.executable, "-c", "import time; print(time.monotonic())"], capture_output=True)
print(abs(float(told.stdout) - time.monotonic()) < 50.0)
"""


def said_by(script: str) -> list[str]:
    done = subprocess.run(
        [sys.executable, "-c", script], check=False, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_a_fork_has_the_id_of_its_parent_and_all_that_it_leaves_ends() -> None:
    assert said_by(FORKED) == ["(True, True)", "7", "no other child", "held", "gone"]


def test_the_clock_leaves_out_what_passed() -> None:
    assert said_by(CLOCK) == ["True", "True True", "True"]
