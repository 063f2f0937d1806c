"""Finds out which middleware a project's files mention."""

from __future__ import annotations

import os
from collections.abc import Iterator

#: how many files are looked into
_FILES = 500


def mentions(root: str, word: str) -> bool:
    """Return whether one of the first program files below a folder contains a word."""
    return any(_has(file, word.encode()) for file in _files(root))


def _files(root: str) -> Iterator[str]:
    """Yield the texts of the first program files below a folder."""
    found = 0
    for folder, folders, files in os.walk(root):
        folders[:] = sorted(name for name in folders if not name.startswith((".", "__")))
        for name in sorted(files):
            if name.endswith(".py") and found < _FILES:
                found += 1
                yield os.path.join(folder, name)


def _has(file: str, word: bytes) -> bool:
    try:
        with open(file, "rb") as opened:
            return word in opened.read()
    except OSError:
        return False
