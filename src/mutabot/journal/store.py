"""One opened journal file: rows in and out, as JSON where they hold more than words and numbers.

What is asked of it and what is written stands in ``reader`` and ``journal``.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol, Self, TypeVar

from mutabot.border.codec import from_data, to_data
from mutabot.errors import JournalError

from .database import Batch, connect, connect_to_read, guarded
from .lock import WriterLock
from .schema import SCHEMA_VERSION, VERSION_KEY
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
    """

    def __init__(
        self,
        path: Path,
        connection: sqlite3.Connection,
        *,
        lock: WriterLock | None = None,
        copy: TemporaryDirectory[str] | None = None,
    ) -> None:
        self.path, self.connection = path, connection
        self._lock, self._copy = lock, copy
        self._batch, self._is_whole = Batch(connection), False

    @classmethod
    def to_read(cls, path: Path) -> Self:
        """Open an existing journal of this version to read it."""
        if not path.is_file():
            raise _no_journal(path)
        refuse_tracked(path)
        with guarded(path):
            connection, copy = connect_to_read(path)
            store = cls(path, connection, copy=copy)
            with store.closed_on_error():
                store.check_version()
        return store

    @classmethod
    def to_write(cls, path: Path, lock: WriterLock) -> Self:
        """Open a journal to write it, whatever is in it; the file is made if there is none."""
        with guarded(path):
            return cls(path, connect(path), lock=lock)

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

    def check_version(self) -> None:
        """Raise JournalError if this is no journal of this version."""
        path = str(self.path)
        tables = {name for (name,) in self.rows("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if not tables:  # of a campaign that was killed before it had begun
            raise _no_journal(self.path)
        if not {"meta", "outcome"} <= tables:
            raise JournalError(f"{path} is a database, but not a journal of mutabot", path=path)
        found = self.fact(VERSION_KEY)
        if found != SCHEMA_VERSION:
            raise JournalError(
                f"{path} was written by another version of mutabot (journal version {found}, this one reads "
                f"{SCHEMA_VERSION}); run the campaign again",
                path=path,
            )

    def rows(self, statement: str, *values: Any) -> list[Any]:
        """What a question is answered with."""
        with guarded(self.path), self._batch.lock:
            if not self._is_whole:
                self._batch.commit()
            return self.connection.execute(statement, values).fetchall()

    def each(self, statement: str) -> Iterator[Any]:
        """What a question is answered with, one row after the other."""
        with guarded(self.path):
            yield from self.connection.execute(statement)

    def read(self, kind: type[T], statement: str) -> list[T]:
        """The objects whose data a question of one column is answered with."""
        return [from_data(kind, json.loads(data)) for (data,) in self.rows(statement)]

    def fact(self, key: str) -> Any:
        """The value of a key of meta; None if it is not there."""
        rows = self.rows("SELECT value FROM meta WHERE key = ?", key)
        return json.loads(rows[0][0]) if rows else None

    def put(self, key: str, value: Any) -> None:
        """Add or replace the value of a key of meta."""
        self.write("INSERT OR REPLACE INTO meta VALUES (?, ?)", key, dump(value))

    def write(self, statement: str, *values: Any) -> None:
        """Carry out one statement, at once with all that waits; within ``transaction``, as a part of it."""
        with guarded(self.path):
            if self._is_whole:
                self.connection.execute(statement, values)
                return
            self._batch.add(statement, *values)
            self._batch.commit()

    def add(self, statement: str, *values: Any) -> None:
        """Carry out one statement; it is committed within a second, or with the next that is at once."""
        with guarded(self.path):
            self._batch.add(statement, *values)

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
                yield lambda statement, *values: self.connection.execute(statement, values)
            except BaseException:
                if self.connection.in_transaction:  # SQLite itself rolls back when the disk is full
                    self.connection.execute("ROLLBACK")
                raise
            finally:
                self._is_whole = False
            self.connection.execute("COMMIT")


def _no_journal(path: Path) -> JournalError:
    return JournalError(f"{path}: there is no journal yet; `mutabot run` writes it", path=str(path))


def dump(value: Any) -> str:
    """A value as JSON."""
    return json.dumps(to_data(value), ensure_ascii=False, default=str)
