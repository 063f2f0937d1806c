"""A journal that is written twice: into the project's file, and into a database without a name.

Programs under test can write to any file of the project, the journal's included. What the controller knows is
therefore kept where no name leads to, in a temporary database that is gone with its process. It is the one
that is read. The file is written beside it, for readers and for the next campaign; at each transaction and at
the end it is looked at, and made anew if it is not what was written.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from .database import Execute, connect, connect_to_read, loaded, stored, write_anew
from .lock import WriterLock
from .marks import differences, mark_rows
from .schema import TABLES

#: what SQLite says where it is the disk that cannot take what is written, and not the file that is wrong
_OF_THE_DISK = ("full", "readonly", "disk I/O", "unable to open")


class Mirrored:
    """Both databases. All that is written is marked.

    Attributes:
        copy: the one that nobody else can write, to be read.
        is_new: whether there was nothing in the file, and nothing is as yet.
        lost: how often the file was deleted or replaced, in words, and was written again.
        altered: rows of the file that somebody else changed, added or removed, and that were restored.
    """

    def __init__(self, path: Path, lock: WriterLock) -> None:
        self._path, self._lock = path, lock
        self.lost: list[str] = []
        self.altered: list[str] = []
        self._is_written, self._known = False, -1
        self._file = connect(path)
        try:
            self.copy = loaded(self._file)
            # the first transaction brings the tables into the file, with what is in them
            self.is_new = not self.copy.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
            if self.is_new:
                self.copy.executescript(TABLES)
            else:
                self._know_file()
            mark_rows(self.copy)
        except BaseException:
            self._file.close()
            raise

    @contextmanager
    def transaction(self, *, whole: bool = False) -> Iterator[Execute]:
        """What is carried out meanwhile takes effect together or not at all, in both.

        Before, the file is compared with what was written if somebody else wrote, and row by row if it is to
        be ``whole``; after, it is written again if it is not so. Raises what SQLite does if the disk is full.
        """
        self._is_written = False
        with self._noted():
            self._file.execute("BEGIN IMMEDIATE")  # from here on nobody else can write
            self._is_written = not self.is_new and self._is_ours(whole)
        self.copy.execute("BEGIN")
        try:
            yield self._execute
            if self._is_written:
                with self._noted():
                    self._file.execute("COMMIT")
            self.copy.execute("COMMIT")
        except BaseException:
            self.copy.rollback()
            raise
        finally:
            with suppress(sqlite3.Error):
                self._file.rollback()
        if not self._is_written:
            self._restore()

    def close(self) -> None:
        """Close both, and give the lock back."""
        self.copy.close()
        self._file.close()
        self._lock.release()

    def _execute(self, statement: str, *given: Any) -> sqlite3.Cursor:
        values = stored(given)
        cursor = self.copy.execute(statement, values)
        if self._is_written:
            with self._noted():
                self._file.execute(statement, values)
        return cursor

    @contextmanager
    def _noted(self) -> Iterator[None]:
        """Go on without the file if it is not as it should be, and say so."""
        try:
            yield
        except sqlite3.Error as error:
            if any(text in str(error) for text in _OF_THE_DISK):
                raise
            self._is_written = False
            if "locked" in str(error):
                self.lost.append("was locked by something else")
            else:
                self.altered.append(f"the file cannot be written any more ({error})")

    def _is_ours(self, whole: bool) -> bool:
        """Whether the file holds what was written; says what does not. ``whole``: every row is looked at."""
        try:
            is_there = self._identity() == self._identity_known
        except OSError:
            is_there = False
        if not is_there:
            self.lost.append("was deleted or replaced")
            return False
        version = self._version()
        found = self._differences() if whole or version != self._known else []
        self.altered += found
        self._known = -1 if found else version
        return not found

    def _differences(self) -> list[str]:
        try:
            with closing(connect_to_read(self._path)) as file:
                return differences(file, self.copy)
        except (sqlite3.Error, OSError) as error:
            return [f"the file cannot be read any more ({error})"]

    def _identity(self) -> tuple[int, int]:
        found = self._path.lstat()
        return found.st_dev, found.st_ino

    def _version(self) -> int:
        """Changes when another connection changes something."""
        return int(self._file.execute("PRAGMA data_version").fetchone()[0])

    def _know_file(self) -> None:
        mark_rows(self._file)
        self._identity_known, self._known = self._identity(), self._version()

    def _restore(self) -> None:
        """Write the file anew, and put it in the place of whatever is there."""
        with suppress(sqlite3.Error):
            self._file.close()
        self._path.parent.mkdir(parents=True, exist_ok=True)
        write_anew(self.copy, self._path)
        self._lock.renew()
        self._file, self.is_new = connect(self._path), False
        self._know_file()
