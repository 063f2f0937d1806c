"""Snapshots of the project's files that outcomes depend on, with digests of their content.

All that tests could import or read, as far as that can be known. Of texts and logs, which people and tools
leave everywhere, only those that something has to do with: which files are opened while the baseline runs, by
by whatever process, is known from the kernel.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import re
import stat
import struct
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath
from types import TracebackType
from typing import TYPE_CHECKING

from mutabot.campaign.project_files import UNREAD, is_folder_of_project, is_name_of_project
from mutabot.config.suppressions import FILE as ACCEPTED_FILE
from mutabot.languages.registry import unit_parser

if TYPE_CHECKING:
    from mutabot.campaign.request import Request

#: stands for the content of data that the unmutated tests write: results, not causes
WRITTEN = "written by the tests themselves"
#: names of what people and tools leave in a folder; any other file counts by its mere presence
_NOTES = {
    ".bak", ".diff", ".dot", ".err", ".gif", ".htm", ".html", ".log", ".md", ".mp4", ".orig", ".out",
    ".patch", ".pdf", ".pid", ".prof", ".rst", ".svg", ".tex", ".tmp", ".txt", ".webm",
}  # fmt: skip
#: how our own JSON begins, and reports of tests and their coverage
_REPORTS = {
    ".json": re.compile(rb'\{\s*"format": \d+,\s*"'),
    ".xml": re.compile(rb".{0,200}<(testsuites?|coverage)\b", re.DOTALL),
}


def counted(
    request: Request, digests: Mapping[str, str], written: Set[str], opened: Set[str] | None
) -> dict[str, str]:
    """Return the files that all outcomes depend on, with their digests.

    Those that the configuration itself consists of count by what they say. A note (``_NOTES``) counts if the
    baseline opened it; a mutant that opens another one says so by itself.

    Args:
        digests: all files of the project.
        written: those that the baseline touched.
        opened: those that were opened meanwhile; None if that is not known.
    """
    own = own_files(request)
    found = {}
    for name, digest in digests.items():
        path = request.root / name
        is_idle = opened is not None and is_note(name) and name not in opened and not path.is_symlink()
        if name not in own and not is_idle and not _is_report(path):
            is_result = name in written and not is_source(name, request)
            found[name] = WRITTEN if is_result else digest
    return found


def is_note(name: str) -> bool:
    """Return whether people or tools leave files of this kind everywhere, such as notes and caches."""
    return PurePosixPath(name).suffix.lower() in _NOTES


def role_of(file: str, request: Request) -> str:
    """Return the role of the calls in a file: ``program``, ``oracle``, or empty."""
    configuration = request.configuration
    for role, sources in (("program", configuration.program), ("oracle", configuration.oracle)):
        if any(source in (".", file) or file.startswith(f"{source}/") for source in sources):
            return role
    return ""


def is_source(file: str, request: Request) -> bool:
    """Return whether a file counts by its units: Python, or program text whose language defines them."""
    return file.endswith(".py") or (unit_parser(file) is not None and role_of(file, request) == "program")


def own_files(request: Request) -> set[str]:
    """Return the files of the configuration, which count by their settings."""
    configuration = request.configuration
    vocabulary = (PurePosixPath(name).as_posix() for name in configuration.vocabulary)
    own = {configuration.file, "pyproject.toml", *vocabulary}
    others = [word[1:] for word in (*request.only, *request.skip) if word.startswith("@")]
    if request.other_journal is not None:
        others += [f"{request.other_journal}{end}" for end in ("", "-wal", "-shm", ".lock")]
    return own | {Path(os.path.relpath(Path(name).resolve(), request.root)).as_posix() for name in others}


def _is_report(path: Path) -> bool:
    """Return whether it is mutabot's own JSON or a report on tests, which no robot program reads."""
    if path.suffix not in _REPORTS:
        return False
    try:
        with path.open("rb") as file:
            return _REPORTS[path.suffix].match(file.read(1000)) is not None
    except OSError:
        return False


#: files for people and for other tools
_FOR_PEOPLE = re.compile(
    r"(README|CHANGELOG|CHANGES|CONTRIBUTING|LICEN[SC]E|AUTHORS)(\.(md|rst|txt|adoc))?", re.IGNORECASE
)


_FOR_TOOLS = {ACCEPTED_FILE, ".gitignore", ".gitattributes", ".editorconfig", ".coverage", ".DS_Store"}
HASH = "#"
_new_hash = partial(hashlib.blake2b, digest_size=12)


@dataclass(frozen=True, slots=True)
class _KnownFile:
    """A file: its metadata, and the digest of its content."""

    status: tuple[int, ...]
    digest: str


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The files of a project at one moment, by their path relative to its root."""

    files: Mapping[str, _KnownFile]

    @property
    def digests(self) -> dict[str, str]:
        """The digests of all files."""
        return {name: file.digest for name, file in self.files.items()}

    @classmethod
    def take(cls, root: Path, before: Snapshot | None = None) -> Snapshot:
        """Read all files, except those that the file system reports untouched since ``before``."""
        known = before.files if before is not None else {}
        found = {}
        for name, path, status in _walk(root):
            same = known.get(name)
            if same is not None and same.status == status:
                found[name] = same
                continue
            digest = _digest_of(path)
            if digest is not None:
                found[name] = _KnownFile(status, digest)
        return cls(found)

    @property
    def folders(self) -> set[str]:
        """The folders with files in them, relative to the root."""
        return {PurePosixPath(name).parent.as_posix() for name in self.files} | {"."}

    def edited_since(self, before: Mapping[str, str]) -> list[str]:
        """Return the files that had another digest in ``before``, or no longer exist."""
        now = self.digests
        return [name for name, was in before.items() if was not in (WRITTEN, now.get(name))]

    def touched_since(self, before: Snapshot) -> set[str]:
        """Return files that were written since ``before``, even with the same content."""
        known = {name: file.status for name, file in before.files.items()}
        return {name for name, file in self.files.items() if file.status != known.get(name)}


def counts_by_name(name: str) -> bool:
    """Return whether a file of this name, relative to the root, could matter."""
    *folders, last = PurePosixPath(name).parts
    is_inside = all(is_name_of_project(folder) for folder in folders)
    return is_inside and not (last.endswith(UNREAD) or last in _FOR_TOOLS or _FOR_PEOPLE.fullmatch(last))


def _walk(root: Path) -> Iterator[tuple[str, Path, tuple[int, ...]]]:
    """Yield the regular files that could matter, with the metadata that shows a change."""
    for folder, folders, names in os.walk(root):
        here = Path(folder)
        folders[:] = sorted(name for name in folders if is_folder_of_project(here / name))
        for name in sorted(names):
            if not counts_by_name(name):
                continue
            path = here / name
            try:
                status = path.stat()
            except OSError:
                continue  # it is gone, or a link to nowhere
            if stat.S_ISREG(status.st_mode):
                times = (status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)
                yield path.relative_to(root).as_posix(), path, times


def digest_of(text: bytes) -> str:
    """Return the digest of a text."""
    return f"{HASH}{_new_hash(text).hexdigest()}"


def _digest_of(path: Path) -> str | None:
    try:
        with path.open("rb") as file:
            return HASH + hashlib.file_digest(file, _new_hash).hexdigest()
    except FileNotFoundError:
        return None
    except OSError as error:
        return f"cannot be read: {error.strerror}"


@dataclass(frozen=True, slots=True)
class State:
    """The files of a project at one moment.

    Attributes:
        files: those that count, with digests of their content.
        notes: digests of the others, which count for what opens them.
        texts: what stands in the program files.
    """

    files: Mapping[str, str]
    notes: Mapping[str, str]
    texts: Mapping[str, bytes]

    @classmethod
    def now(cls, request: Request, before: Snapshot, after: Snapshot, opened: Set[str] | None) -> State:
        """Return the state after the baseline.

        Args:
            before, after: the files before and after the baseline.
            opened: the files that were opened meanwhile; None if that is not known.
        """
        digests = after.digests
        files = counted(request, digests, after.touched_since(before), opened)
        notes = {name: digest for name, digest in digests.items() if name not in files}
        found = {name: read(request.root / name) for name in files if is_source(name, request)}
        return cls(files, notes, {name: text for name, text in found.items() if text is not None})


def read(path: Path) -> bytes | None:
    """Return a file's content; None if it cannot be read."""
    try:
        return path.read_bytes()
    except OSError:
        return None


_IN_OPEN, _IN_Q_OVERFLOW, _IN_ONLYDIR = 0x20, 0x4000, 0x01000000
_EVENT = struct.Struct("iIII")  # watch, mask, cookie, length of the name that follows
_BYTES = 1 << 16


class OpenedFiles:
    """A context manager that notes which files in some folders are opened.

    Args:
        root: the project's folder.
        folders: the folders in it to look at, relative to it.

    Attributes:
        opened: the files, relative to the root, once the watch is over; None where the kernel could not
            report them about all of them.
    """

    def __init__(self, root: Path, folders: Iterable[str]) -> None:
        self.opened: set[str] | None = None
        self._root, self._names = root, sorted(folders)
        self._folders: dict[int, str] = {}
        self._descriptor = -1

    def __enter__(self) -> OpenedFiles:
        libc = ctypes.CDLL(None, use_errno=True)
        self._descriptor = libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
        if self._descriptor < 0:
            return self
        for name in self._names:
            folder = self._root / name
            watch = libc.inotify_add_watch(self._descriptor, os.fsencode(folder), _IN_OPEN | _IN_ONLYDIR)
            if watch < 0 and folder.is_dir():
                self._close()  # too many folders for the kernel
                return self
            self._folders[watch] = "" if name == "." else f"{name}/"
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._descriptor >= 0:
            self.opened = self._read()
            self._close()

    def _close(self) -> None:
        os.close(self._descriptor)
        self._descriptor = -1

    def _read(self) -> set[str] | None:
        found: set[str] = set()
        while True:
            try:
                data = os.read(self._descriptor, _BYTES)
            except BlockingIOError:
                return found
            position = 0
            while position < len(data):
                watch, mask, _, length = _EVENT.unpack_from(data, position)
                position += _EVENT.size + length
                if mask & _IN_Q_OVERFLOW:
                    return None
                name = data[position - length : position].rstrip(b"\0")
                if name:
                    found.add(self._folders.get(watch, "") + os.fsdecode(name))
