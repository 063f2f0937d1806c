"""The way to the campaign goes along with every process, also if it gets an environment of its own."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence
from typing import Any

from mutabot.border.processes import VARIABLE

#: the folder of the start-up module
STARTUP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "startup")
#: which argument of ``fork_exec`` is the environment, <Lib/subprocess.py>
_ENVIRONMENT = 5
_folder = ""


def carry(folder: str) -> None:
    """Let every process that is started from now on find its way to the processes of this folder."""
    global _folder  # noqa: PLW0603  # a copy of a fork server has a folder of its own
    os.environ["PYTHONPATH"] = with_startup(os.environ.get("PYTHONPATH"))
    os.environ[VARIABLE] = folder
    if not _folder:
        _patch()
    _folder = folder


def with_startup(path: str | None) -> str:
    """A ``PYTHONPATH`` with the start-up module first."""
    others = [entry for entry in (path or "").split(os.pathsep) if entry and entry != STARTUP]
    return os.pathsep.join([STARTUP, *others])


def completed(environment: Sequence[bytes]) -> list[bytes]:
    """An environment, as ``NAME=value`` each, with the way in it."""
    given = dict(entry.partition(b"=")[::2] for entry in environment)
    path = given.get(b"PYTHONPATH")
    given[b"PYTHONPATH"] = os.fsencode(with_startup(os.fsdecode(path) if path is not None else None))
    given[os.fsencode(VARIABLE)] = os.fsencode(_folder)
    return [name + b"=" + value for name, value in given.items()]


def _patch() -> None:
    module: Any = subprocess
    start = module._fork_exec

    def fork_exec(*arguments: Any) -> Any:
        environment = arguments[_ENVIRONMENT]
        if environment is not None:
            arguments = (*arguments[:_ENVIRONMENT], completed(environment), *arguments[_ENVIRONMENT + 1 :])
        return start(*arguments)

    module._fork_exec = fork_exec
