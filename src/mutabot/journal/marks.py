"""A journal that is written twice, into the project's file and into a database without a name; and its marks.

A mark is a digest of a row, written with the row, by which rows that somebody else wrote are found. There is
no secret in it: whoever knows how a journal is made can make a mark as well. What a mark shows is that a row
is as some Mutabot wrote it: not damaged, edited, added or taken away by anything else.

Programs under test can write to any file of the project, the journal's included. What the controller knows is
therefore kept where no name leads to, in a temporary database that is gone with its process. It is the one
that is read. The file is written beside it, for readers and for the next campaign; at each transaction and at
the end it is looked at, and made anew if it is not what was written.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from hashlib import blake2b
from pathlib import Path
from typing import Any

from mutabot.journal.lock import WriterLock

from .database import COLUMNS, TABLES, Execute, connect, connect_to_read, decode, loaded, stored, write_anew
from .fitting import is_round

_FUNCTION = "mutabot_mark"
_SIZE = 12
#: characters of a name that are shown
_LONGEST = 150
#: by which column people know a row
_NAMES = {"meta": "key", "test": "test", "mutant": "id", "left_out": "id", "source": "file", "known": "id"}
#: rows that are named before it is said how many more there are
_SHOWN = 5
#: the rows of a table with their marks
_QUESTIONS = {
    table: f"SELECT t.rowid, m.digest, t.* FROM main.{table} AS t "
    f"LEFT JOIN main.mark AS m ON m.\"table\" = '{table}' AND m.row = t.rowid"
    for table in COLUMNS
}
#: what people call rows of a table
_WORDS = {
    "meta": "fact",
    "test": "test of the baseline",
    "left_out": "mutant that was left out",
    "outcome": "outcome",
    "kept": "earlier outcome",
    "known": "earlier mutant",
}


def mark_of(*values: Any) -> bytes:
    """The mark of a row: its table and all its values."""
    text = "\0".join([decode(one) if isinstance(one, bytes) else str(one) for one in values])
    return blake2b(text.encode("utf-8", "surrogateescape"), digest_size=_SIZE).digest()


def mark_rows(connection: sqlite3.Connection) -> None:
    """Have every row that this connection writes marked, and no mark stay of a row that it removes."""
    connection.create_function(_FUNCTION, -1, mark_of, deterministic=True)
    # Without this, a row that is replaced goes without a trigger.
    connection.execute("PRAGMA recursive_triggers = ON")
    for table, columns in COLUMNS.items():
        # as bytes: a text from elsewhere may be no UTF-8
        new = ", ".join(f'CAST(new."{column}" AS BLOB)' for column in columns)
        remove = f"DELETE FROM mark WHERE \"table\" = '{table}' AND row = "
        add = f"INSERT INTO mark VALUES ('{table}', new.rowid, {_FUNCTION}('{table}', {new}));"
        for event, actions in (
            ("INSERT", f"{remove} new.rowid; {add}"),  # there may be one of a row that is gone
            ("DELETE", f"{remove} old.rowid;"),
            ("UPDATE", f"{remove} old.rowid; {add}"),
        ):
            # Temporary: in the file there is nothing but tables.
            connection.execute(
                f"CREATE TEMP TRIGGER mark_{table}_{event} AFTER {event} ON main.{table} BEGIN {actions} END"
            )


def remove_unmarked(execute: Execute) -> list[str]:
    """Remove rows that are not as Mutabot wrote them, and marks of rows that are gone; says which."""
    found = []
    for table in COLUMNS:
        strange = {
            row: name_of(table, values)
            for row, mark, values in _rows(execute(_QUESTIONS[table]))
            if mark != mark_of(table, *values)
        }
        gone = f'FROM mark WHERE "table" = ? AND row NOT IN (SELECT rowid FROM {table})'
        (count,) = execute(f"SELECT count(*) {gone}", table).fetchone()
        for row in strange:
            execute(f"DELETE FROM {table} WHERE rowid = ?", row)
        execute(f"DELETE {gone}", table)
        found += [f"{word_for(table)} {name}" for name in strange.values()]
        if count:
            found.append(f"{count} × {word_for(table)} that {'is' if count == 1 else 'are'} gone")
    return found


def differences(file: sqlite3.Connection, known: sqlite3.Connection) -> list[str]:
    """Rows that were changed, added or removed, and whatever else is in the file, in words."""
    question = "SELECT type, name, sql FROM main.sqlite_master"
    theirs, ours = (set(one.execute(question)) for one in (file, known))
    if theirs != ours:
        strange = sorted(f"{kind} {name}" for kind, name, _ in theirs - ours)
        return [f"the tables are others than were made ({', '.join(strange[:_SHOWN]) or 'some are gone'})"]
    found = [line for table in COLUMNS for line in _differences_in(table, file, known)]
    question = "SELECT count(*) FROM main.mark"
    if not found and file.execute(question).fetchone() != known.execute(question).fetchone():
        found.append("the marks of rows")
    return [*found[:_SHOWN], f"and {len(found) - _SHOWN} more"] if len(found) > _SHOWN else found


def _differences_in(table: str, *connections: sqlite3.Connection) -> Iterator[str]:
    theirs, ours = (
        {
            row: (name_of(table, values), mark, mark_of(*map(repr, values)))
            for row, mark, values in _rows(one.execute(_QUESTIONS[table]))
        }
        for one in connections
    )
    for row in sorted(theirs.keys() | ours.keys()):
        if theirs.get(row) != ours.get(row):
            what = "added" if row not in ours else "removed" if row not in theirs else "changed"
            yield f"{word_for(table)} {(ours.get(row) or theirs[row])[0]} was {what}"


def _rows(cursor: sqlite3.Cursor) -> Iterator[tuple[int, Any, tuple[Any, ...]]]:
    for row, mark, *values in cursor:
        yield row, mark, tuple(values)


def word_for(table: str) -> str:
    """What people call a row of a table."""
    return _WORDS.get(table, table)


def name_of(table: str, values: tuple[Any, ...]) -> str:
    """What people know a row by, not longer than a line; of the values, the first may do."""
    known = dict(zip(COLUMNS[table], values, strict=False))
    if "round" in known and "mutant" in known:
        round = known["round"]
        where = f" in round {round + 1}" if is_round(round) else ""
        return f"{named(known['mutant'])}{where}"
    return named(known[_NAMES.get(table, COLUMNS[table][0])])


def named(value: Any) -> str:
    """A name from a journal as it can be printed, not longer than a line."""
    text = value if isinstance(value, str) else repr(value)
    return repr(text[:_LONGEST].encode("utf-8", "replace").decode())[1:-1]


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
