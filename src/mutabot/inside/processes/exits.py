"""How processes below the tests ended, and by whose signals."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Any

from mutabot.border.signals import ANYBODY

from .killers import starts_a_killer


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
        self._is_on = False

    def watch(self) -> None:
        """Look from now on; it cannot be taken back."""
        if self._is_on:
            return
        self._is_on = True
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
