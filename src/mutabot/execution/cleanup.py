"""Clean up after workers: processes in sessions of their own, and folders.

All that is started below a worker finds the worker's folder in its environment, and the kernel shows with
what environment a process began, whatever its parent is by then. A look at all processes takes about a
millisecond. The folder is removed, whatever the worker has made of it.
"""

from __future__ import annotations

import os
import select
import shutil
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

from mutabot.model.event_file import VARIABLE
from mutabot.model.files import read_file
from mutabot.model.supervisor import name_of

#: looks, each after the last one's finds were killed, until nothing is found
_LOOKS = 20
#: seconds between two looks at a process that is being started
_PAUSE = 0.005
#: the flag of the kernel's own threads, <linux/sched.h>
_KERNEL = 0x00200000
#: milliseconds that killed processes may take to be gone
_PATIENCE = 5000
_PROC = Path("/proc")
#: in the folder of workers: who their controller is, and when it began
OWNER = "controller"


def end_left_over(folder: Path) -> list[str]:
    """End every process that was started below the worker of this folder. Return their names."""
    entry = _mark(folder)
    ended: list[str] = []
    for _ in range(_LOOKS):
        environments = {pid: _environment(pid) for pid in _processes()}
        found = [pid for pid, environment in environments.items() if entry in environment]
        ended += [name for pid in found for name in [name_of(pid)] if _end(pid, entry)]
        if not found:
            # for a moment, a program that is being started has no environment yet
            if not any(
                environment == [b""] and _is_starting(pid) for pid, environment in environments.items()
            ):
                break
            time.sleep(_PAUSE)
    return ended


def claim(folder: Path) -> None:
    """Mark the folder of workers as belonging to this process for as long as it lives."""
    (folder / OWNER).write_text(f"{os.getpid()} {_began(os.getpid())}", encoding="ascii")


def end_abandoned(home: Path) -> int:
    """End processes below workers whose controller was killed. Return how many there were.

    Args:
        home: the folder in which the folders of workers are made.
    """
    ended = 0
    for owner in home.glob(f"*/{OWNER}"):
        try:
            pid, began = read_file(owner, 100).decode("ascii").split()
        except (OSError, ValueError):  # another campaign is about to write it, or to remove it
            continue
        if _began(int(pid)) == began:
            continue
        ended += end_below(owner.parent)
        owner.unlink(missing_ok=True)
    return ended


def end_below(folder: Path) -> int:
    """End all processes below workers whose folders are in this one. Return their number."""
    start = _mark(folder) + b"/"
    marked = [(pid, entry) for pid in _processes() for entry in _environment(pid) if entry.startswith(start)]
    return sum(_end(pid, entry) for pid, entry in marked)


def _mark(folder: Path) -> bytes:
    """Return the environment entry of processes that were started below the worker of this folder."""
    return os.fsencode(f"{VARIABLE}={folder}")


def _began(pid: int) -> str:
    """Return when a process began, as the kernel writes it; empty if it is gone."""
    with suppress(OSError):
        return (_PROC / str(pid) / "stat").read_text("ascii", "replace").rpartition(")")[2].split()[19]
    return ""


def _processes() -> list[int]:
    return [int(name) for name in os.listdir(_PROC) if name.isdigit()]  # noqa: PTH208  # three times as fast


def _environment(pid: int) -> list[bytes]:
    """Return a process's first environment; empty if the process is gone or another user's."""
    with suppress(OSError), open(f"/proc/{pid}/environ", "rb") as file:  # noqa: PTH123  # likewise
        return file.read().split(b"\0")
    return []


def _is_starting(pid: int) -> bool:
    """Return whether a process without an environment is starting, rather than dead or the kernel's own."""
    with suppress(OSError):
        fields = (_PROC / str(pid) / "stat").read_text("ascii", "replace").rpartition(")")[2].split()
        return fields[0] not in "ZX" and not int(fields[6]) & _KERNEL
    return False


def _end(pid: int, entry: bytes) -> bool:
    """End a process and wait until it is gone, unless another one has taken its number."""
    try:
        process = os.pidfd_open(pid)
    except OSError:
        return False
    try:
        if entry not in _environment(pid):
            return False
        with suppress(ProcessLookupError, PermissionError):
            signal.pidfd_send_signal(process, signal.SIGKILL)
        poll = select.poll()
        poll.register(process, select.POLLIN)
        poll.poll(_PATIENCE)
        return True
    finally:
        os.close(process)


def remove_folder(folder: Path) -> None:
    """Remove a folder and its content, as far as its owner may."""
    for _ in range(2):  # the second time all folders are open
        with suppress(RecursionError, OSError):
            shutil.rmtree(folder, ignore_errors=True)
        if os.path.lexists(folder):  # maybe with more folders in each other than Python can go down
            subprocess.run(["rm", "-rf", "--", folder], check=False, stderr=subprocess.DEVNULL)
        if not os.path.lexists(folder):
            return
        _open_up(folder)


def _open_up(folder: Path) -> None:
    """Give the owner of folders the rights to change their content. Links are not followed."""
    with suppress(OSError):
        folder.chmod(0o700)
    for path, names, _ in os.walk(folder):
        for target in (Path(path, name) for name in names):
            with suppress(OSError):
                if not target.is_symlink():
                    target.chmod(0o700)
