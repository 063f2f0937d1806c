"""Find out which files of the project a process reads, and which of them as text rather than to import them.

Text of the program that is read at run time is the original's while a mutant stands in what was compiled.
What only shows lines (tracebacks, warnings) reads nothing that counts, and what ``runpy`` reads is compiled
with the mutant in it.
"""

from __future__ import annotations

import linecache
import os
import sys
from collections.abc import Callable
from functools import wraps
from sys import _getframe
from types import FrameType
from typing import Any

from mutabot.extensions import packages
from mutabot.languages.registry import unit_parser
from mutabot.runtime.paths import real_folder
from mutabot.runtime.processes.commands import STARTS, why_unseen
from mutabot.runtime.processes.environment import FRAMES, listen
from mutabot.runtime.processes.named_files import files_named, starts_python

#: our own audit event: lines of a file are taken, from the cache or not
_LINES = "mutabot.getlines"
#: modules that read files for others, and those that read program text for others
_FOR_OTHERS = ("pathlib", "linecache", "tokenize", "codecs")
_TEXT_FOR_OTHERS = (*_FOR_OTHERS, "inspect")
#: methods of loaders that give the content of a file to their caller
_OF_LOADERS = {"get_data", "get_source"}
#: modules that import; the last is pytest, which rewrites tests
_IMPORTING = ("_frozen_importlib", "importlib._bootstrap", "zipimport", "_pytest.")
#: what reads program text and does nothing with it that a mutant could change: shows lines of it, looks for
#: constants in it (hypothesis), or compiles it with the mutant in it
_HARMLESS = (
    "_pytest", "traceback", "warnings", "logging", "doctest", "unittest", "pdb", "bdb", "runpy", "hypothesis",
)  # fmt: skip


class TextReads:
    """Reports which files of a project this process reads.

    Args:
        root: absolute path of the project.
        on_read: called with each file that is read, relative to the project, and whether that is program text
            that is read as text. Imports of Python files are not reported.
    """

    def __init__(self, root: str, on_read: Callable[[str, bool], None]) -> None:
        self._root, self._on_read = os.path.join(os.path.realpath(root), ""), on_read

    def install(self) -> None:
        """Report from now on."""
        _audit_line_reads()
        listen(("open", _LINES), self._on_audit_event)
        listen(STARTS, self._on_start)

    def name(self, path: str) -> str | None:
        """Return the path of a file of the project, relative to it; None for others."""
        real = path
        if not path.startswith("<"):  # a link in the project is a file of its own
            folder, last = os.path.split(os.path.abspath(path))
            real = os.path.join(real_folder(folder), last)
        if not real.startswith(self._root) or "/site-packages/" in real or "/.mutabot/" in real:
            return None
        return real[len(self._root) :]

    def _on_audit_event(self, event: str, arguments: tuple[Any, ...]) -> None:
        path = arguments[0]
        if not isinstance(path, str | bytes | os.PathLike):
            return
        try:
            frame = _getframe(FRAMES)
        except ValueError:  # the interpreter opens the script that it is to run: that is not read as text
            return
        if event == "open" and arguments[2] & (os.O_WRONLY | os.O_TRUNC):
            return
        name = self.name(os.fsdecode(path))
        if name is None or is_own(frame):
            return
        if not name.endswith(".py"):
            parser = unit_parser(name)
            # the package that runs such files reports by itself which of their units are executed
            if parser is None or not _reader(frame, _FOR_OTHERS).startswith(_package_of(parser)):
                self._on_read(name, False)
        elif not _reader(frame, _FOR_OTHERS).startswith(_IMPORTING):
            package = _reader(frame, _TEXT_FOR_OTHERS).partition(".")[0]
            # packages beside the core run programs, with the mutant in them
            self._on_read(name, package not in _HARMLESS and package not in packages())

    def _on_start(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Report program files that the command line of another program names, as it may read them.

        Python is none: it runs them with the mutant in them, unless it cannot join the campaign. What it then
        runs or imports, it reads.
        """
        if is_own(_getframe(FRAMES)):
            return
        if starts_python(event, arguments) and why_unseen(event, arguments) is None:
            return
        for path in files_named(event, arguments):
            name = self.name(path)
            if name is not None:
                self._on_read(name, True)


def _audit_line_reads() -> None:
    """Raise an audit event where lines of a file are taken: from the cache that takes no opening."""
    take = linecache.getlines
    if hasattr(take, "audits_for_mutabot"):
        return

    @wraps(take)
    def getlines(filename: str, module_globals: Any = None) -> list[str]:
        sys.audit(_LINES, filename)
        return take(filename, module_globals)

    getlines.audits_for_mutabot = True  # type: ignore[attr-defined]  # a mark on it: others may wrap it as well
    linecache.getlines = getlines


def _package_of(function: Callable[..., object]) -> str:
    return function.__module__.partition(".")[0] + "."


def is_own(frame: FrameType | None) -> bool:
    """Return whether mutabot causes an event in a frame, possibly through modules that read program text."""
    return _reader(frame, _FOR_OTHERS[1:]).startswith("mutabot.")


def _reader(frame: FrameType | None, for_others: tuple[str, ...]) -> str:
    """Return the name of the module that reads a file, skipping those that read files for others."""
    while frame is not None:
        name = str(frame.f_globals.get("__name__", ""))
        is_loader = frame.f_code.co_name in _OF_LOADERS and name.startswith(_IMPORTING)
        if not is_loader and name != __name__ and name.partition(".")[0] not in for_others:
            return name
        frame = frame.f_back
    return ""
