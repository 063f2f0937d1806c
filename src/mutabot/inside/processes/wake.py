"""What wakes a process that the tests start: the file that its start-up module reads."""

from __future__ import annotations

import os
from collections.abc import Iterable
from importlib.util import find_spec

from mutabot.border.processes import WAKE
from mutabot.extensions import packages


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


def _folders_of(packages: Iterable[str]) -> list[str]:
    """Where another interpreter finds what the inside needs."""
    places: list[str] = []
    for spec in map(find_spec, packages):
        if spec is not None:
            places += spec.submodule_search_locations or filter(os.path.isabs, [spec.origin or ""])
    return list(dict.fromkeys(map(os.path.dirname, places)))
