"""A file that is to be written: refused before anything runs, and there only when it is whole."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mutabot.errors import UsageError


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
