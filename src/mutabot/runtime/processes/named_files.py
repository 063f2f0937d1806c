"""Find the Python files that the command of a program names which is about to start."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from glob import glob
from itertools import chain
from typing import Any

from mutabot.runtime.processes.commands import is_python, texts_of, words_in

_NAME = re.compile(r"[^\W\d]\w*(\.\w+)*")


def starts_python(event: str, arguments: tuple[Any, ...]) -> bool:
    """Return whether an audit event starts Python, directly or by a shell."""
    return any(map(is_python, words_in(texts_of(event, arguments))))


def files_named(event: str, arguments: tuple[Any, ...]) -> Iterator[str]:
    """Yield the Python files that a command names: as files, and as modules where it starts Python."""
    words = words_in(texts_of(event, arguments))
    folder = os.fsdecode(arguments[2] if event == "subprocess.Popen" and arguments[2] else ".")
    if not any(map(is_python, words)):
        return (path for path in _files(folder, words[1:]) if not os.access(path, os.X_OK))  # no command
    return chain(_files(folder, words[1:]), _modules(folder, words))


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
