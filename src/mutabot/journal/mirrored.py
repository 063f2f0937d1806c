"""A journal that is written twice: into the project's file, and into a database without a name.

Programs under test can write to any file of the project, the journal's included. What the controller knows is
therefore kept where no name leads to, in a temporary database that is gone with its process. It is the one
that is read. The file is written beside it, for readers and for the next campaign; before each transaction
and at the end it is looked at, and made anew if it is not what was written.
"""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

from .database import connect, decode, read_now
from .differences import differences
from .lock import WriterLock
from .marks import mark_rows

#: what SQLite says where it is the disk that cannot take what is written, and not the file that is wrong
_OF_THE_DISK = ("full", "readonly", "disk I/O", "unable to open")


class Mirrored:
    """Both databases, with the part of a connection's interface that the journal's writer needs.

    Attributes:
        lost: how often the file was deleted or replaced, in words, and was written again.
        altered: rows of the file that somebody else changed, added or removed, and that were restored.
    """

    def __init__(self, path: Path, lock: WriterLock | None) -> None:
        self._path, self._lock = path, lock
        self.lost: list[str] = []
        self.altered: list[str] = []
        self._apart = False  # for the rest of a transaction, the file cannot be written
        self._is_marked = False
        self._identity_known, self._known = (0, 0), -1
        self._file = connect(path)
        self._copy = sqlite3.connect("", isolation_level=None, check_same_thread=False)
        self._copy.text_factory = decode
        try:
            self._file.backup(self._copy)
            self._copy.execute("PRAGMA journal_mode = MEMORY")
            self._copy.execute("PRAGMA synchronous = OFF")
            self._know_file()
        except BaseException:
            self.close()
            raise

    def mark_rows(self) -> None:
        """From now on, mark what is written. The tables are there."""
        self._is_marked = True
        for connection in (self._file, self._copy):
            mark_rows(connection)

    @property
    def in_transaction(self) -> bool:
        """Whether a transaction has begun."""
        return self._copy.in_transaction or self._file.in_transaction

    def execute(self, statement: str, values: tuple[Any, ...] = ()) -> sqlite3.Cursor:
        """Carry out a statement on both; questions are answered by the one that nobody else can write."""
        match statement.split(None, 1)[0].upper():
            case "SELECT":
                return self._copy.execute(statement, values)
            case "BEGIN":
                return self._begin()
            case "COMMIT":
                return self._commit()
            case "ROLLBACK":
                return self._roll_back()
        if self._copy.in_transaction:
            return self._change(statement, values)
        self._begin()
        try:
            cursor = self._change(statement, values)
            self._commit()
        except BaseException:  # also what Python says of values
            self._roll_back()
            raise
        return cursor

    def backup(self, target: sqlite3.Connection) -> None:
        """Copy all there is."""
        self._copy.backup(target)

    def check(self) -> None:
        """Compare every row of the file with what was written; what differs is written again."""
        self._look(whole=True)

    def close(self) -> None:
        """Close both."""
        self._copy.close()
        self._file.close()

    def _begin(self) -> sqlite3.Cursor:
        self._apart = False
        self._look()
        try:
            self._file.execute("BEGIN IMMEDIATE")
            # Whoever wrote since the look was quicker; from here on nobody else can.
            if self._version() != self._known:
                self._file.execute("ROLLBACK")
                self._apart = self._note_differences()
                if not self._apart:
                    self._file.execute("BEGIN IMMEDIATE")
        except sqlite3.Error as error:
            self._stay_apart(error)
        return self._copy.execute("BEGIN IMMEDIATE")

    def _change(self, statement: str, values: tuple[Any, ...]) -> sqlite3.Cursor:
        cursor = self._copy.execute(statement, values)
        if not self._apart:
            try:
                self._file.execute(statement, values)
            except sqlite3.Error as error:
                self._stay_apart(error)
        return cursor

    def _commit(self) -> sqlite3.Cursor:
        if not self._apart:
            try:
                self._file.execute("COMMIT")
            except sqlite3.Error as error:
                self._stay_apart(error)
        if self._apart:
            with suppress(sqlite3.Error):
                self._file.execute("ROLLBACK")
        cursor = self._copy.execute("COMMIT")
        if self._apart:
            self._restore()
        return cursor

    def _roll_back(self) -> sqlite3.Cursor:
        if self._file.in_transaction:
            with suppress(sqlite3.Error):
                self._file.execute("ROLLBACK")
        if self._copy.in_transaction:  # SQLite itself rolls back when the disk is full
            return self._copy.execute("ROLLBACK")
        return self._copy.cursor()

    def _stay_apart(self, error: sqlite3.Error) -> None:
        """The file cannot take a statement that the other one took. Raises the error if the disk is why."""
        if any(text in str(error) for text in _OF_THE_DISK):
            raise error
        self._apart = True
        if "locked" in str(error):
            self.lost.append("was locked by something else")
        else:
            self.altered.append(f"the file cannot be written any more ({error})")

    # The file: is it ours still?

    def _look(self, *, whole: bool = False) -> None:
        if not self._is_there():
            self.lost.append("was deleted or replaced")
            self._restore()
            return
        try:
            version = self._version()
        except sqlite3.Error:
            version = -1
        if (whole or version != self._known) and self._note_differences():
            self._restore()
        else:
            self._known = version

    def _note_differences(self) -> bool:
        """Whether the file holds anything else than was written; says what."""
        try:
            with read_now(self._path) as connection:
                found = differences(connection, self._copy)
        except (sqlite3.Error, OSError) as error:
            found = [f"the file cannot be read any more ({error})"]
        self.altered += found
        return bool(found)

    def _is_there(self) -> bool:
        try:
            return self._identity() == self._identity_known
        except OSError:
            return False

    def _identity(self) -> tuple[int, int]:
        found = self._path.lstat()
        return found.st_dev, found.st_ino

    def _version(self) -> int:
        """Changes when another connection changes something."""
        return int(self._file.execute("PRAGMA data_version").fetchone()[0])

    def _know_file(self) -> None:
        self._identity_known = self._identity()
        self._known = self._version()

    def _restore(self) -> None:
        """Write the file anew, and put it in the place of whatever is there."""
        with suppress(sqlite3.Error):
            self._file.close()
        folder, new = self._path.parent, self._path.with_name(f"{self._path.name}.new")
        folder.mkdir(parents=True, exist_ok=True)
        new.unlink(missing_ok=True)
        with closing(sqlite3.connect(new)) as target:
            self._copy.backup(target)
        for suffix in ("-wal", "-shm"):  # they are of the other file: SQLite would read them into this one
            self._path.with_name(self._path.name + suffix).unlink(missing_ok=True)
        if self._path.is_dir() and not self._path.is_symlink():
            shutil.rmtree(self._path)
        new.replace(self._path)
        if self._lock is not None:
            self._lock.renew()
        self._file = connect(self._path)
        if self._is_marked:
            mark_rows(self._file)
        self._know_file()
        self._apart = False
