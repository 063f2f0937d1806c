"""Recordings of a campaign: a file beside the journal, which may be deleted at any time.

A recording is one row, compressed: nothing is lost when a campaign is killed, what is no longer wanted makes
room, and reports read one without the others. Of a mutant only what differs from the original is kept.
"""

from __future__ import annotations

import os
import sqlite3
import stat
from collections.abc import Iterable
from enum import IntEnum
from pathlib import Path
from typing import Any, Self

from mutabot.errors import JournalError

from .database import connect, connect_to_read, guarded, loaded
from .files import BESIDE, HOME, clear, recordings_path

_TABLE = """
CREATE TABLE IF NOT EXISTS recording (
    mutant TEXT, round INTEGER, test TEXT, rank INTEGER, size INTEGER, data BLOB,
    PRIMARY KEY (mutant, round, test)
) WITHOUT ROWID
"""
#: stands for the original in the place of a mutant's id
ORIGINAL = ""


class Rank(IntEnum):
    """The order in which recordings are removed when room is needed."""

    OTHER = 0
    SURVIVOR = 1
    ORIGINAL = 2


class Recordings:
    """The opened file of recordings; use as a context manager. All methods raise JournalError on failure.

    Attributes:
        path: the file.
        used: bytes of all recordings together.
        dropped: how many made room for others, or found none.
        removed: description of what lay in the place of the file and had to go; empty if nothing did.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection, limit: int = 0) -> None:
        self.path, self._connection, self._limit = path, connection, limit
        self.used = self.dropped = 0
        self.removed = ""

    @classmethod
    def to_write(cls, journal: Path, limit: int) -> Recordings:
        """Open the recordings of this journal for writing.

        The file is made if there is none, or something else is in its place in Mutabot's own folder.

        Args:
            limit: bytes that all recordings together may take.
        """
        path, is_ours = recordings_path(journal), journal.parent.name == HOME
        with guarded(path):
            removed = _what_is_there(path)
            if removed and not is_ours:
                raise JournalError(f"{path} is {removed}, where recordings are to be written; remove it")
            if removed:
                _remove(path)
            try:
                found = cls._opened(path, limit)
            except sqlite3.DatabaseError as error:
                if not (is_ours and _is_foreign(error)):
                    raise
                removed = "a file of something else, or damaged"
                _remove(path)
                found = cls._opened(path, limit)
        found.removed = removed
        return found

    @classmethod
    def _opened(cls, path: Path, limit: int) -> Self:
        found = cls(path, connect(path), limit)
        try:
            found._connection.execute("PRAGMA auto_vacuum = INCREMENTAL")
            found._connection.execute(_TABLE)
            rows = found._connection.execute("SELECT coalesce(sum(size), 0) FROM recording").fetchall()
            found.used = int(rows[0][0])
        except BaseException:
            found.close()
            raise
        return found

    @classmethod
    def to_read(cls, journal: Path, *, copied: bool = False) -> Recordings | None:
        """Open the recordings of a journal to read; None if there are none. ``copied``: open a copy."""
        path = recordings_path(journal)
        if not os.path.lexists(path):
            return None
        hint = f"remove it, and what is recorded from now on is kept: rm -r {path}"
        there = _what_is_there(path)
        if there:
            raise JournalError(f"{path} holds no recordings: it is {there}; {hint}")
        with guarded(path):
            try:
                found = connect_to_read(path)
                return cls(path, loaded(found) if copied else found)
            except sqlite3.DatabaseError as error:
                if not _is_foreign(error):
                    raise
                raise JournalError(f"{path} holds no recordings ({error}); {hint}") from error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._connection.close()

    def forget(self, mutant: str, round: int) -> None:
        """Remove the recordings of a mutant, or of the original, in a round."""
        self._delete("mutant = ? AND round = ?", mutant, round)

    def add(self, mutant: str, round: int, test: str, rank: Rank, data: bytes) -> bool:
        """Add a recording, removing ones of lower rank if needed. Return whether there was room."""
        if self.used + len(data) > self._limit and not self._make_room(rank, len(data)):
            self.dropped += 1
            return False
        with guarded(self.path):
            self._connection.execute(
                "INSERT OR REPLACE INTO recording VALUES (?, ?, ?, ?, ?, ?)",
                (mutant, round, test, int(rank), len(data), data),
            )
        self.used += len(data)
        return True

    def tests(self, mutant: str, round: int) -> tuple[str, ...]:
        """Return the tests that have a recording."""
        rows = self._rows("SELECT test FROM recording WHERE mutant = ? AND round = ?", mutant, round)
        return tuple(test for (test,) in rows)

    def data(self, mutant: str, round: int, test: str) -> bytes | None:
        """Return a recording, as ``evidence.recording.to_bytes`` wrote it; None if there is none."""
        rows = self._rows(
            "SELECT data FROM recording WHERE mutant = ? AND round = ? AND test = ?", mutant, round, test
        )
        return bytes(rows[0][0]) if rows else None

    def pairs(self) -> list[tuple[str, int]]:
        """Return the mutants and rounds that have recordings; ``ORIGINAL`` stands for the original."""
        return [
            (str(mutant), int(round))
            for mutant, round in self._rows("SELECT DISTINCT mutant, round FROM recording")
        ]

    def of(self, mutant: str, round: int) -> list[tuple[str, Rank, bytes]]:
        """Return test, rank and data of each recording of a mutant in a round."""
        rows = self._rows(
            "SELECT test, rank, data FROM recording WHERE mutant = ? AND round = ?", mutant, round
        )
        return [(str(test), Rank(rank), bytes(data)) for test, rank, data in rows]

    def take(self, others: Iterable[Recordings], mutants: set[str]) -> None:
        """Copy recordings of several journals, the first of equal ones; keep those of ``mutants`` only."""
        self.keep_only(mutants)
        done: set[tuple[str, int]] = set()
        for other in others:
            own = [pair for pair in other.pairs() if pair not in done]
            for mutant, round in own:
                self.forget(mutant, round)
                for test, rank, data in other.of(mutant, round):
                    self.add(mutant, round, test, rank, data)
            done.update(own)

    def keep_only(self, mutants: set[str]) -> None:
        """Remove the recordings of all other mutants."""
        for (mutant,) in self._rows("SELECT DISTINCT mutant FROM recording WHERE mutant != ''"):
            if mutant not in mutants:
                self._delete("mutant = ?", mutant)

    def _make_room(self, rank: Rank, size: int) -> bool:
        lower = "SELECT mutant, round, test FROM recording WHERE rank < ? ORDER BY rank, size DESC"
        for mutant, round, test in self._rows(lower, rank):
            if self.used + size <= self._limit:
                break
            self._delete("mutant = ? AND round = ? AND test = ?", mutant, round, test)
            self.dropped += 1
        with guarded(self.path):
            self._connection.execute("PRAGMA incremental_vacuum")
        return self.used + size <= self._limit

    def _delete(self, which: str, *values: object) -> None:
        freed = self._total(which, *values)
        if freed:
            with guarded(self.path):
                self._connection.execute(f"DELETE FROM recording WHERE {which}", values)
            self.used -= freed

    def _total(self, which: str = "1", *values: object) -> int:
        return int(self._rows(f"SELECT coalesce(sum(size), 0) FROM recording WHERE {which}", *values)[0][0])

    def _rows(self, statement: str, *values: object) -> list[tuple[Any, ...]]:
        with guarded(self.path):
            return self._connection.execute(statement, values).fetchall()


_KINDS = {stat.S_IFLNK: "a link", stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe"}


def _what_is_there(path: Path) -> str:
    """Return the kind of file that has the file's name but is no plain file; empty if none."""
    for suffix in BESIDE:
        name = path.with_name(path.name + suffix)
        kind = stat.S_IFMT(name.lstat().st_mode) if os.path.lexists(name) else stat.S_IFREG
        if kind != stat.S_IFREG:
            return _KINDS.get(kind, "no plain file")
    return ""


def _remove(path: Path) -> None:
    """Remove a file or folder to make room; of a link only the link."""
    for suffix in BESIDE:
        clear(path.with_name(path.name + suffix))


def _is_foreign(error: sqlite3.DatabaseError) -> bool:
    """Return whether a file is not an SQLite database, is damaged, or has other tables."""
    return any(message in str(error) for message in ("not a database", "malformed", "no such column"))
