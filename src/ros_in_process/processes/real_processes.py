"""Refuses to start nodes outside this process, where they are not simulated, and names the command."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from ros_in_process.errors import NeedsRealRos
from ros_in_process.machine.imports import refuse

#: packages that start nodes in real processes, out of sight of the project's modules
_LAUNCHERS = ("launch", "launch_ros", "launch_testing", "launch_testing_ros", "launch_pytest")
#: programs that start nodes which are not Python's, or not seen here
_STARTERS = {"ros2", "roslaunch", "gz", "gazebo", "ign", "gzserver", "rviz2"}
#: audit events of Python for the start of a process, and which of their arguments is the command
_EVENTS = {"subprocess.Popen": 1, "os.system": 0, "os.posix_spawn": 1, "os.exec": 1}
#: after these, a shell begins another command
_OPERATORS = {";", "&", "&&", "|", "||", "(", "exec", "time", "env"}

#: gives the program of the project that a command starts, None if it starts another
ProgramOf = Callable[[list[str], str], object]


def words_of(command: Any) -> list[str]:
    """Return the words of a command as `subprocess.Popen` takes it."""
    if isinstance(command, str | bytes | os.PathLike):
        command = [command]
    return [os.fsdecode(word) for word in command]


def is_python(program: str) -> bool:
    """Return whether a command's first word is a Python interpreter."""
    return program == sys.executable or os.path.basename(program).startswith("python")


def starts_nodes(program: str) -> bool:
    """Return whether a command's first word is a ROS tool that starts nodes, or an installed node."""
    prefixes = [prefix for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    return os.path.basename(program) in _STARTERS or any(
        os.path.realpath(program).startswith(os.path.join(prefix, "lib", "")) for prefix in prefixes
    )


def refused(words: list[str]) -> NeedsRealRos:
    """Return the error that names a command."""
    return NeedsRealRos(f"`{' '.join(words)[:80]}` starts nodes outside this process")


def _refuse_launcher(name: str) -> None:
    raise NeedsRealRos(f"the package {name} starts nodes outside this process")


def _audit(program_of: ProgramOf, event: str, arguments: tuple[Any, ...]) -> None:
    """Refuse to start a program of the project as a real process, for example by a shell or library."""
    if event not in _EVENTS:
        return
    words = words_of(arguments[_EVENTS[event]])
    folder = arguments[2] if event == "subprocess.Popen" else None
    for started in _commands(words):
        if program_of(started, os.fsdecode(folder or os.getcwd())) is not None:
            raise refused(words)


def _commands(words: list[str]) -> Iterator[list[str]]:
    """Yield the commands that a command starts, also those in its texts that a shell would run."""
    texts = [_read_as_shell(word) for word in words if len(words) == 1 or " " in word]
    for text in (words, *texts):
        for index, word in enumerate(text):
            if not index or text[index - 1] in _OPERATORS or is_python(word):
                yield text[index:]


def _read_as_shell(text: str) -> list[str]:
    reader = shlex.shlex(text, posix=True, punctuation_chars=True)
    reader.whitespace_split = True
    try:
        return list(reader)
    except ValueError:  # a quotation mark that is not closed: no command
        return []


def install(program_of: ProgramOf) -> None:
    """Refuse from now on to start nodes outside this process."""
    for name in _LAUNCHERS:
        refuse(name, partial(_refuse_launcher, name))
    sys.addaudithook(partial(_audit, program_of))
