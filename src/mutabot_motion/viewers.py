"""The ways to view a recording, as options request them. Each needs its own extra.

A file is refused before anything runs, and there only when it is whole.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from mutabot.api.reports import UsageError

from .view import MotionView

#: by the module that imports it: the library, the option that needs it, and the extra that brings it
_NEEDS = {
    "rrd": ("rerun-sdk", "--rrd needs (and --rerun)", "rerun"),
    "mcap": ("foxglove-sdk", "--mcap needs", "mcap"),
    "pictures.video": ("PyAV and Pillow", "--video needs", "video"),
}


#: of files, by the end of their names: what they are, and the bytes that each has from a place on
_FILES = {
    ".rrd": ("recording", 0, b"RRF2"),
    ".mcap": ("recording", 0, b"\x89MCAP0\r\n"),
    ".mp4": ("video", 4, b"ftyp"),
    ".gif": ("video", 0, b"GIF8"),
}

#: one way to look at it: returns a sentence on what there is now, and raises UsageError where it fails
Viewer = Callable[[MotionView], str]


def viewers_of(home: Path, *, rerun: bool, rrd: Path | None, mcap: Path | None) -> Iterator[Viewer]:
    """Return the requested views. Raises UsageError for a view that is not available here.

    ``home``: the project's folder of mutabot, for a file that the user does not name.
    """
    if rerun or rrd is not None:
        of_rerun = module("rrd")
        if rrd is not None:
            check(rrd, ".rrd")
        opened = partial(of_rerun.open_viewer, home=home) if rerun else None
        yield lambda view: written(of_rerun, rrd or home / f"{view.name}.rrd", view, opened)
    if mcap is not None:
        of_mcap = module("mcap")
        check(mcap, ".mcap")
        yield partial(written, of_mcap, mcap)


def written(target: Any, file: Path, view: MotionView, opened: Callable[[Path], str] | None = None) -> str:
    """Write a recording by a module of this package, open it, and return a description of the result."""
    with atomic_file(file) as part:
        target.write(part, view)
    description = f"{file}: {file.stat().st_size / 1e3:.0f} kB for {target.READER}"
    return f"{description}; {opened(file)}" if opened is not None else description


def module(name: str) -> Any:
    """Return a module of this package. Raises UsageError if the library that it needs is not installed."""
    library, needs, extra = _NEEDS[name]
    try:
        return import_module(f"{__package__}.{name}")
    except ImportError as error:
        install = f"pip install 'path/to/mutabot[{extra}]'"
        raise UsageError(f"{needs} {library}, not installed here: {install}") from error


def check(file: Path, *suffixes: str) -> None:
    """Raise UsageError if a file with these suffixes cannot be written there, or would be overwritten."""
    suffix = file.suffix.lower()
    what, at, magic = _FILES[suffix if suffix in suffixes else suffixes[0]]
    cannot = f"the {what} {file} cannot be written"
    if suffix not in suffixes:
        raise UsageError(f"{cannot}: its name must end in {' or '.join(suffixes)}")
    if file.is_dir():
        raise UsageError(f"{cannot}: it is a folder")
    if not file.parent.is_dir():
        raise UsageError(f"{cannot}: there is no folder {file.parent}")
    if not os.access(file.parent, os.W_OK):
        raise UsageError(f"{cannot}: the folder {file.parent} is read-only")
    if file.exists() and not _begins(file, magic, at):
        raise UsageError(f"{cannot}: a file of that name exists and is not a {what}")


def _begins(file: Path, magic: bytes, at: int) -> bool:
    with file.open("rb") as opened:
        return opened.read(at + len(magic))[at:] == magic


@contextmanager
def atomic_file(file: Path) -> Iterator[Path]:
    """Yield a path beside the file; when all is written, it replaces the file, else nothing is left."""
    part = file.with_name(f".{file.stem}.part{file.suffix}")
    try:
        yield part
        part.replace(file)
    except OSError as error:
        raise UsageError(f"{file} cannot be written: {error.strerror or error}") from error
    finally:
        part.unlink(missing_ok=True)


def has_screen() -> bool:
    """Return whether a window can be opened."""
    return sys.platform != "linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
