"""One opened journal file: rows in and out, as JSON where they hold more than words and numbers.

What is asked of it and what is written stands in ``reader`` and ``journal``.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import AbstractContextManager, closing, contextmanager
from pathlib import Path
from typing import Any, Self

from mutabot.border.codec import to_data
from mutabot.border.storable import storable

from .database import OF_ONE_ROW, Execute, connect_to_read, guarded, loaded, stored
from .fitting import load
from .lock import WriterLock
from .marks import remove_unmarked
from .mirrored import Mirrored
from .sound import check_schema, no_journal
from .tracked import refuse_tracked

#: characters of a value that are shown
_SHOWN = 100


class Store:
    """What is in a journal, in a database that nobody else can write; with the file of its writer.

    Every method raises JournalError when the file cannot be read or written.

    Attributes:
        path: the file.
        connection: to read with.
        unmarked: rows that something else than Mutabot has written, in words; they are left out.
        unstored: why rows could not be stored, one line each: all others are.
        is_new: whether there was nothing in the file.
        lost, altered: as in ``Mirrored``.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection, file: Mirrored | None = None) -> None:
        self.path, self.connection, self._file = path, connection, file
        self._execute: Execute | None = None  # within a transaction
        self.unmarked: list[str] = []
        self.unstored: list[str] = []
        self.is_new = file is not None and file.is_new
        self.lost, self.altered = (file.lost, file.altered) if file is not None else ([], [])

    @classmethod
    def to_read(cls, path: Path) -> Self:
        """What is now in an existing journal of this version."""
        if not path.is_file():
            raise no_journal(path)
        refuse_tracked(path)
        with guarded(path):
            with closing(connect_to_read(path)) as file:
                store = cls(path, loaded(file))
            with store.closed_on_error():
                check_schema(path, store.connection)
                store.unmarked = remove_unmarked(lambda text, *values: store.connection.execute(text, values))
                store.connection.execute("PRAGMA query_only = ON")
        return store

    @classmethod
    def to_write(cls, path: Path, lock: WriterLock) -> Self:
        """Open a journal to write it, whatever is in it; the file is made if there is none."""
        with guarded(path):
            file = Mirrored(path, lock)
        return cls(path, file.copy, file)

    def close(self) -> None:
        """Close the file; the lock of a writer is given back."""
        (self._file or self.connection).close()

    @contextmanager
    def closed_on_error(self) -> Iterator[None]:
        """Close the file if what is done meanwhile fails."""
        try:
            yield
        except BaseException:
            self.close()
            raise

    def _begin(self, *, whole: bool = False) -> AbstractContextManager[Execute]:
        assert self._file is not None
        return self._file.transaction(whole=whole)

    def check(self) -> None:
        """Compare the file with what was written, and write again what is not so."""
        with guarded(self.path), self._begin(whole=True):
            pass

    def remove_unmarked(self) -> None:
        """Drop what something else than Mutabot has written; within ``transaction``."""
        assert self._execute is not None
        self.unmarked = remove_unmarked(self._execute)

    def rows(self, statement: str, *values: Any) -> list[Any]:
        """What a question is answered with."""
        with guarded(self.path):
            return self.connection.execute(statement, stored(values)).fetchall()

    def fact(self, key: str) -> Any:
        """The value of a key of meta; None if it is not there."""
        rows = self.rows("SELECT value FROM meta WHERE key = ?", key)
        return load(rows[0][0]) if rows else None

    def put(self, key: str, value: Any) -> None:
        """Add or replace the value of a key of meta."""
        self.write("INSERT OR REPLACE INTO meta VALUES (?, ?)", key, dump(value))

    def write(self, statement: str, *values: Any) -> None:
        """Carry out one statement; within ``transaction``, as a part of it."""
        with guarded(self.path):
            if self._execute is not None:
                self._execute(statement, *values)
                return
            with self._begin() as execute:
                execute(statement, *values)

    def add(self, statement: str, *values: Any) -> None:
        """Add a row; one that cannot be stored takes no other with it."""
        with guarded(self.path):
            try:
                with self._begin() as execute:
                    execute(statement, *values)
            except OF_ONE_ROW as error:
                what = ", ".join(str(value)[:_SHOWN] for value in values[:2])
                self.unstored.append(f"{what}: {type(error).__name__}: {error}")

    @contextmanager
    def transaction(self) -> Iterator[Execute]:
        """Several statements that take effect together or not at all."""
        with guarded(self.path):
            try:
                with self._begin() as self._execute:
                    yield self._execute
            finally:
                self._execute = None


def dump(value: Any) -> str:
    """A value as JSON that can be stored."""
    try:
        text = json.dumps(to_data(value), ensure_ascii=False, default=str)
        text.encode()
    except (ValueError, RecursionError):  # what no other process said: the names of files, for instance
        return json.dumps(storable(value, str), ensure_ascii=False)
    return text
