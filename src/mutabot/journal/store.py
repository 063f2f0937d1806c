"""One opened journal file: rows in and out, as JSON where they hold more than words and numbers.

What is asked of it and what is written stands in ``reader`` and ``journal``.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol, Self, TypeVar

from mutabot.border.codec import to_data
from mutabot.border.storable import printable, storable

from .database import Batch, Connection, connect_to_read, guarded
from .fitting import load
from .lock import WriterLock
from .marks import leave_out
from .mirrored import Mirrored
from .sound import check_schema, no_journal
from .tracked import refuse_tracked

T = TypeVar("T")


class Execute(Protocol):
    """Runs one statement with its values."""

    def __call__(self, statement: str, *values: Any) -> sqlite3.Cursor: ...


class Store:
    """A connection to the file of a journal, with the lock of its writer or the copy that a reader needs.

    Every method raises JournalError when the file cannot be read or written.

    Attributes:
        path: the file.
        connection: SQLite's own; whoever uses it beside the methods calls ``flush`` before.
        unmarked: rows that something else than Mutabot has written, in words: questions leave them out.
    """

    def __init__(
        self,
        path: Path,
        connection: Connection,
        *,
        lock: WriterLock | None = None,
        copy: TemporaryDirectory[str] | None = None,
    ) -> None:
        self.path, self.connection = path, connection
        self._lock, self._copy = lock, copy
        self._batch, self._is_whole = Batch(connection), False
        self.unmarked: list[str] = []

    @classmethod
    def to_read(cls, path: Path) -> Self:
        """Open an existing journal of this version to read it."""
        if not path.is_file():
            raise no_journal(path)
        refuse_tracked(path)
        with guarded(path):
            connection, copy = connect_to_read(path)
            store = cls(path, connection, copy=copy)
            with store.closed_on_error():
                check_schema(path, connection)
                store.unmarked = leave_out(connection)
                connection.execute("PRAGMA query_only = ON")
        return store

    @classmethod
    def to_write(cls, path: Path, lock: WriterLock) -> Self:
        """Open a journal to write it, whatever is in it; the file is made if there is none."""
        with guarded(path):
            return cls(path, Mirrored(path, lock), lock=lock)

    def close(self) -> None:
        """Close the file; the lock of a writer is given back."""
        try:
            self.flush()
        finally:
            self.connection.close()
            if self._lock is not None:
                self._lock.release()
            if self._copy is not None:
                self._copy.cleanup()

    @contextmanager
    def closed_on_error(self) -> Iterator[None]:
        """Close the file if what is done meanwhile fails."""
        try:
            yield
        except BaseException:
            self.close()
            raise

    def mark_rows(self) -> None:
        """Have all rows marked that are written from now on."""
        assert isinstance(self.connection, Mirrored)
        with guarded(self.path):
            self.connection.mark_rows()

    def check(self) -> None:
        """Compare the file with what was written, and write again what is not so."""
        assert isinstance(self.connection, Mirrored)
        self.flush()
        with guarded(self.path), self._batch.lock:
            self.connection.check()

    @property
    def lost(self) -> list[str]:
        """How often the file was deleted or replaced, and written again, in words."""
        return self.connection.lost if isinstance(self.connection, Mirrored) else []

    @property
    def altered(self) -> list[str]:
        """What somebody else changed in the file, and was written again."""
        return self.connection.altered if isinstance(self.connection, Mirrored) else []

    def rows(self, statement: str, *values: Any) -> list[Any]:
        """What a question is answered with."""
        with guarded(self.path), self._batch.lock:
            if not self._is_whole:
                self._batch.commit()
            return self.connection.execute(statement, stored(values)).fetchall()

    def each(self, statement: str) -> Iterator[Any]:
        """What a question is answered with, one row after the other."""
        with guarded(self.path):
            yield from self.connection.execute(statement)

    def fact(self, key: str) -> Any:
        """The value of a key of meta; None if it is not there."""
        rows = self.rows("SELECT value FROM meta WHERE key = ?", key)
        return load(rows[0][0]) if rows else None

    def put(self, key: str, value: Any) -> None:
        """Add or replace the value of a key of meta."""
        self.write("INSERT OR REPLACE INTO meta VALUES (?, ?)", key, dump(value))

    def write(self, statement: str, *values: Any) -> None:
        """Carry out one statement, at once with all that waits; within ``transaction``, as a part of it."""
        with guarded(self.path):
            if self._is_whole:
                self.connection.execute(statement, stored(values))
                return
            self._batch.add(statement, *stored(values))
            self._batch.commit()

    def add(self, statement: str, *values: Any) -> None:
        """Carry out one statement; it is committed within a second, or with the next that is at once."""
        with guarded(self.path):
            self._batch.add(statement, *stored(values))

    @property
    def unstored(self) -> tuple[str, ...]:
        """Why rows could not be stored, one line each: all others are."""
        return tuple(self._batch.unstored)

    def flush(self) -> None:
        """Commit all that waits."""
        with guarded(self.path):
            self._batch.commit()

    @contextmanager
    def transaction(self) -> Iterator[Execute]:
        """Several statements that take effect together or not at all."""
        with guarded(self.path), self._batch.lock:
            self._batch.commit()
            self.connection.execute("BEGIN IMMEDIATE")
            self._is_whole = True
            try:
                yield lambda statement, *values: self.connection.execute(statement, stored(values))
            except BaseException:
                if self.connection.in_transaction:  # SQLite itself rolls back when the disk is full
                    self.connection.execute("ROLLBACK")
                raise
            finally:
                self._is_whole = False
            self.connection.execute("COMMIT")


def stored(values: Iterable[Any]) -> tuple[Any, ...]:
    """Values of a row, with texts that can be stored."""
    return tuple(printable(value) if isinstance(value, str) else value for value in values)


def dump(value: Any) -> str:
    """A value as JSON that can be stored."""
    try:
        text = json.dumps(to_data(value), ensure_ascii=False, default=str)
        text.encode()
    except (ValueError, RecursionError):  # what no other process said: the names of files, for instance
        return json.dumps(storable(value, str), ensure_ascii=False)
    return text
