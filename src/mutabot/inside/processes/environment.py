"""The way to the campaign, for every process that the tests start: its environment, and the file ``wake``.

The environment goes along also where a process is given one of its own. It leads to the start-up module, and
that reads in ``wake`` what is of interest.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from typing import Any

from mutabot.border.processes import VARIABLE, WAKE
from mutabot.extensions import packages

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


def write_wake(folder: str, join: str, names: Iterable[str], files: Iterable[str]) -> None:
    """Say what is of interest.

    Args:
        folder: the folder of the campaign's processes.
        join: the module whose ``join`` is called, with this folder, in a process of interest.
        names: top-level names of modules.
        files: real paths of files and folders.
    """
    own = sorted({*packages(), "wrapt"})
    lines = [
        f"join {join}",
        *(f"path {place}" for place in _folders_of(own)),
        *(f"own {name}" for name in own),
        *(f"name {name}" for name in sorted(set(names))),
        *(f"file {file}" for file in files),
    ]
    with open(os.path.join(folder, WAKE), "w", encoding="utf-8", errors="surrogateescape") as file:
        file.write("".join(f"{line}\n" for line in lines))


def _folders_of(names: Iterable[str]) -> list[str]:
    """Where another interpreter finds what the inside needs."""
    places: list[str] = []
    for spec in map(find_spec, names):
        if spec is not None:
            places += spec.submodule_search_locations or filter(os.path.isabs, [spec.origin or ""])
    return list(dict.fromkeys(map(os.path.dirname, places)))
