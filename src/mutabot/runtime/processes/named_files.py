"""Find the Python files that the command of a program names which is about to start."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from glob import glob
from itertools import chain
from typing import Any

from mutabot.languages.imported_names import imported_names
from mutabot.model.files import read_file
from mutabot.runtime.processes.commands import (
    command_of,
    folder_of,
    is_python,
    scripts_named,
    texts_of,
    words_in,
)

#: bytes in which the first line of a script ends
_FIRST_LINE = 256
_NAME = re.compile(r"[^\W\d]\w*(\.\w+)*")


def starts_python(event: str, arguments: tuple[Any, ...]) -> bool:
    """Return whether an audit event starts Python, directly or by a shell."""
    return any(map(is_python, words_in(texts_of(event, arguments))))


def files_named(event: str, arguments: tuple[Any, ...]) -> Iterator[str]:
    """Yield the Python files that a command names: as files, and as modules where it starts Python."""
    words, folder = words_in(texts_of(event, arguments)), folder_of(event, arguments)
    if not any(map(is_python, words)):
        return (path for path in _files(folder, words[1:]) if not os.access(path, os.X_OK))  # no command
    scripts = (path for path, _ in scripts_named(command_of(event, arguments), folder))
    return chain(_files(folder, words[1:]), _modules(folder, words), filter(_is_of_python, scripts))


def _is_of_python(path: str) -> bool:
    """Return whether a file is a script that Python runs."""
    try:
        line = read_file(path, _FIRST_LINE).partition(b"\n")[0]
    except (OSError, ValueError):
        return False
    return line.startswith(b"#!") and b"python" in line


def _files(folder: str, words: Iterable[str]) -> Iterator[str]:
    """Yield the Python files that words name, also by patterns."""
    for word in words:
        yield from filter(os.path.isfile, glob(os.path.join(folder, word)) if word.endswith(".py") else ())


def _modules(folder: str, words: Iterable[str]) -> Iterator[str]:
    """Yield the files of modules in a folder that words name: ``-m cell``, ``import cell``, ``cell.go()``."""
    for word in filter(_NAME.fullmatch, words):
        parts = word.split(".")
        for number in range(1, len(parts) + 1):
            place = os.path.join(folder, *parts[:number])
            yield from filter(os.path.isfile, (f"{place}.py", *glob(os.path.join(place, "*.py"))))


def imports_of(path: str) -> frozenset[str]:
    """Return what a Python file may import, see ``imported_names``; nothing of one that cannot be read."""
    try:
        return imported_names(read_file(path))
    except (OSError, ValueError):
        return frozenset()
