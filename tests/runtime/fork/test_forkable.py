"""What makes a process unsafe to fork is noticed, however it came about."""

from __future__ import annotations

import ctypes.util
import os
import subprocess
import sys

import pytest

from mutabot.runtime.isolation.forkable import why_not

ASK = """
from mutabot.runtime.isolation.forkable import open_now, why_not
known = open_now()
{}
print(why_not((), known))
"""
LOCK = "import fcntl, tempfile; file = tempfile.TemporaryFile()"
BLOCK = "import signal; signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGUSR1])"


def asked(code: str) -> str:
    result = subprocess.run(
        [sys.executable, "-c", ASK.format(code)], capture_output=True, text=True, check=True
    )
    return result.stdout.strip()


def test_plain_process_is_safe() -> None:
    assert asked("") == "None"


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("import threading; threading.Thread(target=threading.Event().wait, daemon=True).start()", "thread"),
        ("import socket; s = socket.socket()", "1 open socket"),
        ("import subprocess; p = subprocess.Popen(['sleep', '1'])", "1 subprocess in flight"),
        (f"{LOCK}; fcntl.flock(file, fcntl.LOCK_SH)", "a lock on /"),
        (f"{LOCK}; fcntl.lockf(file, fcntl.LOCK_EX, 1)", "a lock on /"),
        (f"{BLOCK}; signal.raise_signal(signal.SIGUSR1)", "blocked and waits (SIGUSR1)"),
    ],
)
def test_what_a_fork_would_share_or_lack_is_named(code: str, reason: str) -> None:
    assert reason in asked(code)


@pytest.mark.parametrize(
    "code",
    [
        f"{LOCK}; fcntl.lockf(file, fcntl.LOCK_EX); fcntl.lockf(file, fcntl.LOCK_UN)",
        f"{BLOCK}; signal.raise_signal(signal.SIGUSR1); signal.sigwait([signal.SIGUSR1])",
    ],
)
def test_what_is_over_is_no_reason(code: str) -> None:
    assert asked(code) == "None"


def test_graphics_library_is_noticed_however_it_was_loaded() -> None:
    library = next(filter(None, map(ctypes.util.find_library, ("EGL", "GL", "OSMesa"))), None)
    if library is None:
        pytest.skip("no graphics library here")
    assert "a graphics library is loaded" in asked(f"import ctypes; ctypes.CDLL({library!r})")


def test_own_forks_are_no_reason() -> None:
    pid = os.fork()
    if pid == 0:
        os.read(os.pipe()[0], 1)
        os._exit(0)
    try:
        reason = why_not((pid,), frozenset())
        assert reason is None or "subprocess" not in reason
    finally:
        os.kill(pid, 9)
        os.waitpid(pid, 0)
