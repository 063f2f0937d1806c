"""Processes below the tests: which are started out of sight, how each ended, and by whose signals."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from typing import Any

from mutabot.border.processes import ANYBODY

#: options of Python by which it leaves out the environment, or what is loaded at its start
_APART = {"-I": "the option -I", "-E": "the option -E", "-S": "the option -S"}
#: programs that are started to end others: nobody can know from outside whom they end;
#: with ``timeout`` and the launchers of ROS, which end what they have started
_KILLERS = {
    "kill",
    "pkill",
    "killall",
    "skill",
    "fuser",
    "timeout",
    "rosnode",
    "roslaunch",
    "rostest",
    "ros2",
}
#: what runs a command that it is given
_RUNNERS = {"sh", "bash", "dash", "zsh", "ksh", "env", "sudo", "nice", "nohup", "setsid", "xargs"}
_KILLER_IN_TEXT = re.compile(rf"(?<![\w.-])(?:{'|'.join(sorted(_KILLERS))})(?![\w.-])")


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


def starts_a_killer(event: str, arguments: tuple[Any, ...]) -> bool:
    """Whether an audit event is the start of a program that may end others, itself or by a shell."""
    if event == "os.system":
        return _mentions_killer(arguments[:1])
    if event in ("subprocess.Popen", "os.posix_spawn", "os.exec"):
        command = arguments[1]
        return _is_killer([command] if isinstance(command, str | bytes | os.PathLike) else list(command))
    return False


def _is_killer(command: Sequence[Any]) -> bool:
    name = os.path.basename(os.fsdecode(command[0])) if command else ""
    return name in _KILLERS or (name in _RUNNERS and _mentions_killer(command[1:]))


def _mentions_killer(words: Sequence[Any]) -> bool:
    return any(_KILLER_IN_TEXT.search(os.fsdecode(word)) for word in words)


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
