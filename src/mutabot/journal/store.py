"""One opened journal file: rows in and out, as JSON where they hold more than words and numbers.

What is asked of it and what is written stands in ``reader`` and ``journal``. A file may come from anybody. A
view or a trigger in it would be evaluated with each question, for as long as whoever wrote it liked, so there
may be none: only the tables that this version makes. What lies where a journal is to be written is taken
over, kept beside it, or refused.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import AbstractContextManager, closing, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, Self

from mutabot.errors import JournalError
from mutabot.journal.files import previous_of
from mutabot.journal.lock import WriterLock, refuse_tracked
from mutabot.model.codec import storable, to_data

from .database import (
    OF_ONE_ROW,
    SCHEMA_VERSION,
    SUFFIXES,
    TABLES,
    VERSION_KEY,
    Execute,
    connect,
    connect_to_read,
    guarded,
    loaded,
    stored,
    write_anew,
)
from .fitting import UNFIT, load
from .marks import Mirrored, remove_unmarked

#: things in a file that are looked at: a journal has fewer
_MOST = 100
_MOST_VERSIONS = 1_000_000
_Thing = tuple[str, str, str | None]


@cache
def _made() -> frozenset[_Thing]:
    """What this version makes."""
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.executescript(TABLES)
        return frozenset(connection.execute("SELECT type, name, sql FROM sqlite_master"))


def check_schema(path: Path, connection: sqlite3.Connection) -> None:
    """Raise JournalError if this is no journal of this version."""
    question = "SELECT type, name, sql FROM main.sqlite_master LIMIT ?"
    found: set[_Thing] = set(connection.execute(question, (_MOST,)))
    if not found:  # of a campaign that was killed before it had begun
        raise no_journal(path)
    tables = {name for kind, name, _ in found if kind == "table"}
    if not {"meta", "outcome"} <= tables:
        raise JournalError(f"{path} is a database, but not a journal of mutabot", path=str(path))
    strange = sorted(f"{kind} {name}" for kind, name, _ in found - _made())
    if "table meta" not in strange:
        version = _version(connection)
        # a version that cannot be read is one row that is damaged, if all tables are ours
        if version != SCHEMA_VERSION and (version is not None or strange):
            raise JournalError(
                f"{path} was written by another version of mutabot (journal version {version or '?'}, "
                f"this one reads {SCHEMA_VERSION}); run the campaign again",
                path=str(path),
                version=version,
            )
    if strange or _made() - found:
        what = f"holds what no journal has ({', '.join(strange[:3])})" if strange else "lacks a table"
        raise JournalError(
            f"{path} {what}, so something else than mutabot has changed it; run the campaign again",
            path=str(path),
        )


def _version(connection: sqlite3.Connection) -> int | None:
    row = connection.execute("SELECT value FROM main.meta WHERE key = ?", (VERSION_KEY,)).fetchone()
    with suppress(*UNFIT):
        found = load(row[0]) if row is not None else None
        return found if isinstance(found, int) and abs(found) < _MOST_VERSIONS else None
    return None


def no_journal(path: Path) -> JournalError:
    """There is nothing there."""
    return JournalError(f"{path}: there is no journal yet; `mutabot run` writes it", path=str(path))


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


def make_way(path: Path) -> Path | None:
    """Move aside what lies there and is no journal of this version; returns where to.

    A journal of another version gets that as part of its name, so that no later campaign overwrites it;
    a damaged one takes the place of the previous one.

    Raises JournalError for a file that is not ours.
    """
    for half in (path, previous_of(path)):  # of a campaign that was killed meanwhile
        half.with_name(f"{half.name}.new").unlink(missing_ok=True)
    if not path.exists():
        return None
    with path.open("rb") as file:
        start = file.read(16)
    if start and not start.startswith(b"SQLite format 3"):
        raise JournalError(f"{path} is in the way: it is not a journal of mutabot", path=str(path))
    kept = previous_of(path)
    try:
        if _is_journal(path):
            return None
    except JournalError as error:
        if error.version is None:
            raise
        kept = path.with_name(f"{path.stem}.version-{error.version}{path.suffix}")
    if _is_empty(path):  # of a campaign that was killed before it had begun
        return None
    for suffix in SUFFIXES:
        old, new = path.with_name(path.name + suffix), kept.with_name(kept.name + suffix)
        new.unlink(missing_ok=True)
        if old.exists():
            old.replace(new)
    return kept


def keep_copy(store: Store) -> None:
    """Keep the campaign of an opened journal as it is, as ``previous_of`` its path."""
    with guarded(store.path):
        write_anew(store.connection, previous_of(store.path))


def _is_empty(path: Path) -> bool:
    with suppress(sqlite3.DatabaseError), closing(connect(path)) as connection:
        return connection.execute("SELECT 1 FROM sqlite_master").fetchone() is None
    return False


def _is_journal(path: Path) -> bool:
    """Whether it is a sound journal of this version. Raises JournalError for one of another version."""
    try:
        with closing(connect(path)) as connection:
            check_schema(path, connection)
            (sound,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    except (JournalError, sqlite3.DatabaseError) as error:
        cause = error.__cause__ if isinstance(error, JournalError) else error
        if isinstance(cause, sqlite3.OperationalError):
            raise  # it is not the content that is wrong: a full disk, a folder that cannot be written
        if isinstance(error, JournalError) and error.version is not None:
            raise
        return False
    return bool(sound == "ok")
