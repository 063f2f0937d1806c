"""The locks on a project: one campaign at a time writes its journal, and whoever works there says so."""

from __future__ import annotations

import fcntl
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mutabot.errors import JournalError


class WriterLock:
    """Held by the one process that writes a journal; the system gives it back when that process dies."""

    def __init__(self, journal: Path, descriptor: int) -> None:
        self._journal = journal
        self._descriptor: int | None = descriptor

    @classmethod
    def take(cls, journal: Path) -> WriterLock:
        """Take the lock of a journal. Raises JournalError if another process holds it."""
        descriptor = os.open(journal.with_name(journal.name + ".lock"), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC)
        # A reader that looks whether somebody writes holds it for a moment, hence more than one try.
        for _ in range(10):
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                time.sleep(0.02)
            else:
                return cls(journal, descriptor)
        os.close(descriptor)
        raise JournalError(f"{journal} is being written by another `mutabot run`", path=str(journal))

    def renew(self) -> None:
        """Take it again if its file is gone. Raises JournalError if another process has it by now."""
        if self._descriptor is None:
            return
        try:
            found = self._journal.with_name(self._journal.name + ".lock").stat()
        except OSError:
            found = None
        held = os.fstat(self._descriptor)
        if found is None or (found.st_dev, found.st_ino) != (held.st_dev, held.st_ino):
            other = WriterLock.take(self._journal)
            os.close(self._descriptor)
            self._descriptor, other._descriptor = other._descriptor, None

    def release(self) -> None:
        """Give the lock back; a second time does nothing."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


def is_written(journal: Path) -> bool:
    """Whether some process writes this journal now."""
    try:
        descriptor = os.open(journal.with_name(journal.name + ".lock"), os.O_RDONLY | os.O_CLOEXEC)
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
    """Say that somebody works in mutabot's folder; the first to come removes what killed ones left there."""
    try:
        home.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(home, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError as error:
        raise JournalError(f"cannot write to {home}: {error.strerror}", path=str(home)) from error
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
