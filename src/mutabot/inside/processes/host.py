"""The test process's side: what it gives to processes below it, and what it makes of what they tell."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

from mutabot.border.job import Job
from mutabot.border.processes import FOLDER, SUFFIX, Began, Entry, entry_of
from mutabot.extensions import brought

from .carried import carry
from .exits import Exits
from .now import Now
from .wake import write_wake

#: what processes of interest load
_JOIN = "mutabot.inside.processes.member"


@dataclass(slots=True)
class Diaries:
    """The files of all members, as far as they have been read.

    The tests know the folder, and so does whatever they start: files may be gone or damaged.

    Attributes:
        doubt: why what they tell cannot be relied on, or None.
    """

    folder: str
    doubt: str | None = None
    _read: dict[str, int] = field(default_factory=dict)

    def new(self) -> list[tuple[str, list[Entry]]]:
        """Entries that are new, by file."""
        try:
            names = [name for name in sorted(os.listdir(self.folder)) if name.endswith(SUFFIX)]
        except OSError:
            names = []
            self._doubt("their folder was deleted")
        if not self._read.keys() <= set(names):
            self._doubt("a file was deleted")
        found = []
        for name in names:
            try:
                entries = self._new_in(name)
            except OSError as error:
                self._doubt(f"{name} cannot be read ({error.strerror})")
                continue
            if entries:
                found.append((name, entries))
        return found

    def _doubt(self, why: str) -> None:
        self.doubt = self.doubt or f"what processes below the tests reported was damaged: {why}"

    def _new_in(self, name: str) -> list[Entry]:
        start = self._read.get(name, 0)
        with open(os.path.join(self.folder, name), "rb") as file:
            if os.fstat(file.fileno()).st_size < start:
                self._doubt(f"{name} is shorter than it was")
            file.seek(start)
            data = file.read()
        # What comes after the last line break is being written, or its writer was killed meanwhile.
        whole = data[: data.rfind(b"\n") + 1]
        self._read[name] = start + len(whole)
        found = [entry for line in whole.splitlines() if (entry := self._entry(line, name)) is not None]
        if start == 0 and found and not _is_by_owner(found[0], name):
            self._doubt(f"{name} was not begun by its process")
        return found

    def _entry(self, line: bytes, name: str) -> Entry | None:
        try:
            entry = entry_of(line)
        except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
            entry = None
        if entry is None:
            self._doubt(f"{name} holds a line that no process writes")
        return entry


def _is_by_owner(first: Entry, name: str) -> bool:
    """Whether a file begins as that of the process that it is named after."""
    return isinstance(first, Began) and str(first.pid) == name.partition("-")[0]


class Host:
    """The processes below a test process.

    Args:
        home: the home of the test process.
        job: its job.

    Attributes:
        diaries: what members have written.
        exits: how processes ended, as far as the test process knows.
        number: the running test's.
    """

    def __init__(self, home: str, job: Job) -> None:
        self.folder = os.path.join(home, FOLDER)
        os.mkdir(self.folder)
        self._write_wake(job)
        self._now = Now(self.folder, is_host=True)
        self.diaries = Diaries(self.folder)
        self.exits = Exits()

    @property
    def number(self) -> int:
        """The number of the running test."""
        return self._now.number

    def open(self) -> None:
        """Let every Python process that is started from now on find its way here."""
        carry(self.folder)
        self.exits.watch()

    def start_test(self, test: str) -> None:
        """A test begins."""
        self._now.begin(test)

    def _write_wake(self, job: Job) -> None:
        names: set[str] = set()
        nodes = {_top(module) for module in brought("middlewares")}  # what any node imports
        for operation in job.vocabulary.operations:
            names.update(nodes if operation.named is not None else [_top(operation.target)])
        if job.vocabulary.clock is not None:
            names.add(_top(job.vocabulary.clock.tick))
        files = [os.path.realpath(os.path.join(job.root, path)) for path in (*job.program, *job.oracle)]
        for path in (*job.program, *job.oracle):
            names.update(part.removesuffix(".py") for part in path.split("/") if part not in (".", "..", ""))
        write_wake(self.folder, _JOIN, names, files)


def _top(target: str) -> str:
    return target.partition(":")[0].partition(".")[0]
