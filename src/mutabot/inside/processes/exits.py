"""What the test process notes of the processes that it starts: which are out of sight, how each ended, and by
whose signals.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from typing import Any

from mutabot.border.processes import ANYBODY

from .killers import starts_a_killer

#: options of Python by which it leaves out the environment, or what is loaded at its start
_APART = {"-I": "the option -I", "-E": "the option -E", "-S": "the option -S"}


class Exits:
    """What the test process knows of the ends of its children.

    Attributes:
        codes: exit codes by process, negative for a signal.
        signalled: processes, and groups (negative), that the tests sent a signal to; ``ANYBODY`` if they
            started what does so.
    """

    def __init__(self) -> None:
        self.codes: dict[int, int] = {}
        self.signalled: set[int] = set()

    def watch(self) -> None:
        """Look from now on; it cannot be taken back."""
        self._watch_waiting()
        self._watch_popen()
        sys.addaudithook(self._hear)

    def _watch_waiting(self) -> None:
        wait = os.waitpid

        def waitpid(pid: int, options: int, /) -> tuple[int, int]:
            found, status = wait(pid, options)
            if found:
                self.codes[found] = os.waitstatus_to_exitcode(status)
            return found, status

        os.waitpid = waitpid

    def _watch_popen(self) -> None:
        kind: Any = subprocess.Popen
        handle = kind._handle_exitstatus

        def handled(popen: Any, status: int, *more: Any) -> None:
            handle(popen, status, *more)
            if popen.returncode is not None:
                self.codes[popen.pid] = popen.returncode

        kind._handle_exitstatus = handled

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event == "os.kill":
            self.signalled.add(arguments[0])
        elif event == "os.killpg":
            self.signalled.add(-arguments[0])
        elif starts_a_killer(event, arguments):
            self.signalled.add(ANYBODY)


def watch_unseen(tell: Callable[[str, str], None]) -> None:
    """Look from now on which processes are started that do not find their way to the campaign.

    ``tell`` is told the command and why nothing in it is seen. It cannot be taken back.
    """

    def hear(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "subprocess.Popen":
            words = _words(*arguments[:2])
            why = _why(words)
            if why is not None:
                tell(" ".join(words[:3]), why)

    sys.addaudithook(hear)


def _words(executable: Any, command: Any) -> list[str]:
    try:
        given = [command] if isinstance(command, str | bytes | os.PathLike) else list(command)
        words = [os.fsdecode(word) for word in given]
        return [os.fsdecode(executable), *words[1:]] if executable is not None else words
    except TypeError:  # it will not start either
        return []


def _why(words: Sequence[str]) -> str | None:
    if not words or not os.path.basename(words[0]).startswith("python"):
        return None
    for word in words[1:]:
        if not word.startswith("-"):
            break
        if word in _APART:
            return f"{_APART[word]} keeps it apart"
    return None
