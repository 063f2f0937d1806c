"""The ways to look at what is recorded, as they are asked for. Each needs an extra of its own.

A file is refused before anything runs, and there only when it is whole.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

from mutabot.errors import UsageError

from .shown import Shown

#: by the module that imports it: the library, the option that needs it, and the extra that brings it
_NEEDS = {
    "rrd": ("rerun-sdk", "--rrd needs (and --rerun)", "rerun"),
    "mcap": ("foxglove-sdk", "--mcap needs", "mcap"),
    "view": ("MuJoCo", "--view needs", "cells"),
    "pictures.video": ("PyAV and Pillow", "--video needs", "video"),
}


class Sight(Protocol):
    """One way to look at it. It is made before anything is read: UsageError says that it cannot be done."""

    def show(self, shown: Shown) -> str:
        """Do it. Returns what there is now, in words. Raises UsageError where it fails."""


def sights_of(home: Path, *, view: bool, rerun: bool, rrd: Path | None, mcap: Path | None) -> Iterator[Sight]:
    """Those that are asked for. Raises UsageError for one that cannot be done here.

    ``home``: the project's folder of mutabot.
    """
    if rerun or rrd is not None:
        yield module("rrd").Rrd(home, rrd, opens=rerun)
    if mcap is not None:
        yield module("mcap").Mcap(mcap)
    if view:
        yield module("view").Viewer()


def module(name: str) -> Any:
    """A module of this package. Raises UsageError if the library that it needs is not installed."""
    library, needs, extra = _NEEDS[name]
    try:
        return import_module(f"{__package__}.{name}")
    except ImportError as error:
        install = f"pip install 'path/to/mutabot[{extra}]'"
        raise UsageError(f"{needs} {library}, not installed here: {install}") from error


def check(file: Path, what: str, suffix: str, magic: bytes, at: int = 0) -> None:
    """Raise UsageError if such a file cannot be written there.

    Args:
        what: what it is, such as ``video``.
        suffix: what its name ends with.
        magic: the bytes that every such file has, from byte ``at`` on: no other file is written over.
    """
    cannot = f"the {what} {file} cannot be written"
    if file.suffix.lower() != suffix:
        raise UsageError(f"{cannot}: its name must end in {suffix}")
    if file.is_dir():
        raise UsageError(f"{cannot}: it is a folder")
    if not file.parent.is_dir():
        raise UsageError(f"{cannot}: there is no folder {file.parent}")
    if not os.access(file.parent, os.W_OK):
        raise UsageError(f"{cannot}: the folder {file.parent} is read-only")
    if file.exists() and not _begins(file, magic, at):
        raise UsageError(f"{cannot}: there is another file of that name, which is no {what}")


def _begins(file: Path, magic: bytes, at: int) -> bool:
    with file.open("rb") as opened:
        return opened.read(at + len(magic))[at:] == magic


@contextmanager
def written_whole(file: Path) -> Iterator[Path]:
    """Where to write: beside the file, whose place it takes when all is written; else nothing is left."""
    part = file.with_name(f".{file.stem}.part{file.suffix}")
    try:
        yield part
        part.replace(file)
    except OSError as error:
        raise UsageError(f"{file} cannot be written: {error.strerror or error}") from error
    finally:
        part.unlink(missing_ok=True)


def has_screen() -> bool:
    """Whether a window can be opened."""
    return sys.platform != "linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
