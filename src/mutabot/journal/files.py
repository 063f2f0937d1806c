"""Mutabot's files in a project, and the lock that lets one campaign at a time write a journal.

What a journal says is believed: outcomes in it are taken over, and gates are decided by it. One that git
tracks was written by the author of the commit, such as a stranger's pull request, which would judge itself.
It is refused.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mutabot.errors import JournalError
from mutabot.model.files import open_file
from mutabot.repository import GitError, repository_of, tracked

#: mutabot's folder in a project, and its journal
HOME = ".mutabot"
JOURNAL = "journal.sqlite"
#: by this file a folder is known to be a report of ours: it may be replaced, and no test depends on it
REPORT_MARK = "mutabot-report.txt"


def find_journal(project: Path) -> Path:
    """Return the journal of the project, also for a folder inside it.

    If there is none, where it would be.
    """
    folders = (project.resolve(), *project.resolve().parents)
    paths = [folder / HOME / JOURNAL for folder in folders]
    return next((path for path in paths if path.is_file()), paths[0])


def previous_of(journal: Path) -> Path:
    """Return the path of the previous complete campaign's journal: ``journal.previous.sqlite``."""
    return journal.with_name(f"{journal.stem}.previous{journal.suffix}")


def recordings_path(journal: Path) -> Path:
    """Return the path of the recordings of a journal's campaigns."""
    return journal.with_name(f"{journal.stem}-evidence.sqlite")


#: the ends of the names of a database's file and of what SQLite keeps beside it, and reads
BESIDE = ("", "-wal", "-shm", "-journal")


def clear(path: Path) -> None:
    """Remove a file, folder or link; the target of a link stays."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


class WriterLock:
    """The lock of the process that writes a journal, which the system releases when that process dies."""

    def __init__(self, journal: Path, descriptor: int) -> None:
        self._journal = journal
        self._descriptor: int | None = descriptor

    @classmethod
    def take(cls, journal: Path) -> WriterLock:
        """Take the lock of a journal. Raises JournalError if another process holds it."""
        journal.parent.mkdir(parents=True, exist_ok=True)
        lock = journal.with_name(journal.name + ".lock")
        if os.path.lexists(lock) and not stat.S_ISREG(lock.lstat().st_mode):
            clear(lock)  # no process holds that
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
        # A reader that looks for a writer holds it for a moment, hence more than one try.
        for _ in range(10):
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                time.sleep(0.02)
            else:
                return cls(journal, descriptor)
        os.close(descriptor)
        raise JournalError(f"{journal} is being written by another `mutabot run`")

    def renew(self) -> None:
        """Take the lock again if its file is gone. Raises JournalError if another process has it now."""
        if self._descriptor is None:
            return
        try:
            found = self._journal.with_name(self._journal.name + ".lock").lstat()
        except OSError:
            found = None
        held = os.fstat(self._descriptor)
        if found is None or (found.st_dev, found.st_ino) != (held.st_dev, held.st_ino):
            other = WriterLock.take(self._journal)
            os.close(self._descriptor)
            self._descriptor, other._descriptor = other._descriptor, None

    def release(self) -> None:
        """Release the lock; a second time does nothing."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


def is_written(journal: Path) -> bool:
    """Return whether some process writes this journal now."""
    try:
        descriptor = open_file(journal.with_name(journal.name + ".lock"), os.O_RDONLY)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


@contextmanager
def at_work(home: Path) -> Iterator[None]:
    """Mark mutabot's folder as in use; the first user cleans up after killed processes.

    Also folders that their controllers had not claimed yet, or had begun to remove.
    """
    try:
        home.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(home, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError as error:
        raise JournalError(f"cannot write to {home}: {error.strerror}") from error
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            pass
        else:
            for left_behind in home.glob("work-*"):
                shutil.rmtree(left_behind, ignore_errors=True)
        fcntl.flock(descriptor, fcntl.LOCK_SH)
        yield
    finally:
        os.close(descriptor)


def refuse_tracked(journal: Path) -> None:
    """Raise JournalError if git tracks a journal, a file beside it that belongs to it, or a link on the way.

    Also if git cannot answer: then it is unknown where the journal comes from.
    """
    here = Path(os.path.abspath(journal))  # noqa: PTH100  # links stay links
    links = (folder for folder in (here, *here.parents) if folder.is_symlink())
    for path in (here, *links, Path(os.path.realpath(here))):
        found = _tracked_at(path, journal)
        if found:
            raise JournalError(_why(journal, path.parent, found))


def _tracked_at(path: Path, journal: Path) -> list[str]:
    """Return the tracked files of those that belong to the journal at ``path``, relative to its folder."""
    folder = path.parent
    names = [HOME] if folder.name == HOME else []
    if names:
        folder = folder.parent
    else:
        files = (path, recordings_path(path), previous_of(path), recordings_path(previous_of(path)))
        names = [file.name + end for file in files for end in BESIDE]
        names.append(f"{path.stem}-suggestions.json")
    if repository_of(folder) is None or not any(os.path.lexists(folder / name) for name in names):
        return []
    try:
        return tracked(folder, *names)
    except GitError as error:
        why = f"it is not known whether {journal} came with the repository; then it is not used: {error}"
        raise JournalError(why) from error


def _why(journal: Path, folder: Path, names: list[str]) -> str:
    first = names[0]
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    option = "-r " if folder.name == HOME else ""
    what = HOME if option else first
    return (
        f"the journal {journal} is not used, since git tracks {first}{more}: its author "
        f"decides what it says. Take it out of the repository with `git rm --cached {option}{what}`, add "
        f"{HOME}/ to .gitignore, and keep journals for CI in a cache outside of the checkout"
    )
