"""Which file of the project a path stands for: without links, and for a copy the original.

Tests copy the program and run the copy: beside other files, in a folder of its own, in a zip file. Code that
edits the program by hand changes what such a copy holds as well. So a file that was written after the session
has begun, and holds the text of a file of the program, is mutated at the same places. Older files with the
same text are others, as an edit of the program does not reach them.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from importlib.util import decode_source
from stat import S_ISREG

from mutabot.model.files import read_file

#: a folder without symbolic links; there are few, and hundreds of files in them
real_folder = cache(os.path.realpath)
#: when this process began, ns since the epoch
BEGAN = time.time_ns()
#: larger files are no copies of programs, bytes
_LARGEST = 4_000_000
#: when a file was written, ns since the epoch, and its size
_Stamp = tuple[int, int]


@cache
def real_path(path: str) -> str:
    """Return the path of a file without symbolic links; for a copy of a file of the program, of that file."""
    found = _without_links(path)
    return (_copies.original(found) if _copies is not None else None) or found


def _without_links(path: str) -> str:
    if not os.path.isabs(path):
        return os.path.realpath(path)
    folder, name = os.path.split(path)
    found = os.path.join(real_folder(folder), name)
    return os.path.realpath(found) if name in ("", ".", "..") or os.path.islink(found) else found


class _Copies:
    """Knows copies of the program's files.

    Args:
        places: real paths of the program's files and folders.
        since: when the session began, ns since the epoch.

    Attributes:
        seen: files that are younger than that, as they were when they were looked at.
    """

    def __init__(self, places: tuple[str, ...], since: int) -> None:
        self._places, self._since = places, since
        self._texts: dict[str, tuple[_Stamp, str]] = {}
        self.seen: dict[str, _Stamp] = {}

    def original(self, path: str) -> str | None:
        """Return the file of the program that this is a copy of; None for all others."""
        if path.startswith("<") or any(is_below(path, place) for place in self._places):
            return None
        file, state = _state(path)
        if state is None or state[0] < self._since:
            return None
        self.seen[path] = state
        text = _text(path, file)
        same = [known for known, found in self.program() if found == text] if text else []
        return max(same, key=lambda known: _common_end(known, path), default=None)

    def is_young(self, name: str) -> bool:
        """Return whether a file was written since the session began, and is none of the program."""
        path = real_path(name)
        return path in self.seen and self.original(path) is None

    def is_written_again(self, path: str) -> bool:
        """Return whether a file is not the one that was looked at."""
        known = self.seen.get(path)
        return known is not None and known != _state(path)[1]

    def program(self) -> Iterator[tuple[str, str]]:
        """Yield each file of the program with what it holds now, which a mutant may have changed."""
        for path in _python_files(self._places):
            _, state = _state(path)
            known = self._texts.get(path)
            if state is not None and (known is None or known[0] != state):
                known = self._texts[path] = (state, _text(path, path))
            if known is not None:
                yield path, known[1]


_copies: _Copies | None = None
#: what forgets the answers of ``real_path``
_forgetting: list[Callable[[], None]] = [real_path.cache_clear]


def watch_copies(root: str, program: Iterable[str], since: int) -> None:
    """Take copies of the program for the program from now on.

    Args:
        root: absolute path of the project.
        program: its files and folders, relative to the root.
        since: copies are younger than this, ns since the epoch.
    """
    global _copies  # noqa: PLW0603  # one process, one program
    _copies = _Copies(tuple(os.path.realpath(os.path.join(root, path)) for path in program), since)
    forget()


def is_young(name: str) -> bool:
    """Return whether code with this file name may come from a text that a test has made."""
    return _copies is not None and (name.startswith("<") or _copies.is_young(name))


def program_texts() -> Iterator[tuple[str, str]]:
    """Yield the path of each file of the program with what it holds; nothing before ``watch_copies``."""
    yield from _copies.program() if _copies is not None else ()


def forget_with(forget_more: Callable[[], None]) -> None:
    """Call this whenever answers of ``real_path`` may have become others."""
    _forgetting.append(forget_more)


def look_again(path: str) -> None:
    """Forget what is known of a file that is about to be compiled, if it was written again."""
    if _copies is not None and _copies.is_written_again(_without_links(path)):
        forget()


def forget() -> None:
    """Forget all answers."""
    for forget_answers in _forgetting:
        forget_answers()


def is_below(path: str, folder: str) -> bool:
    """Return whether a path is a folder or lies in it."""
    return path == folder or path.startswith(folder.rstrip("/") + "/")


def _python_files(places: Iterable[str]) -> Iterator[str]:
    for place in places:
        if not os.path.isdir(place):
            yield place
        for folder, _, names in os.walk(place):
            yield from (os.path.join(folder, name) for name in names if name.endswith(".py"))


def _state(path: str) -> tuple[str, _Stamp | None]:
    """Return the file that holds what a path names, a zip file for its members, and that file's state."""
    file = path
    while len(file) > 1:
        try:
            found = os.stat(file)
        except NotADirectoryError:
            file = os.path.dirname(file)
            continue
        except (OSError, ValueError):
            break
        return file, ((found.st_ctime_ns, found.st_size) if S_ISREG(found.st_mode) else None)
    return path, None


def _text(path: str, file: str) -> str:
    """Return what a file or a member of a zip file holds, with plain line ends; empty if it is no text."""
    try:
        if os.stat(file).st_size > _LARGEST:
            return ""
        data = read_file(file) if path == file else _member(file, path[len(file) + 1 :])
        return decode_source(data) if data.strip() else ""
    except (OSError, ValueError, SyntaxError):
        return ""


def _member(archive: str, name: str) -> bytes:
    """Return what a member of a zip file holds. Raises OSError if there is none, or it cannot be read."""
    from zipfile import BadZipFile, ZipFile  # noqa: PLC0415  # of no use to most processes below the tests

    try:
        with ZipFile(archive) as members:
            return members.read(name)
    except (KeyError, BadZipFile, NotImplementedError, RuntimeError) as error:
        raise OSError(str(error)) from error


def _common_end(one: str, other: str) -> int:
    """Return how many names two paths have in common at their ends."""
    pairs = zip(reversed(one.split(os.sep)), reversed(other.split(os.sep)), strict=False)
    return next((number for number, (mine, yours) in enumerate(pairs) if mine != yours), len(one))
