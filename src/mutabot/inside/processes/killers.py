"""Programs that are started to end others: nobody can know from outside whom they end."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from typing import Any

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
