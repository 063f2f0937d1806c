"""The SQLite file of a journal: its tables, one writer, readers beside it, errors that say what to do.

What the writer knows is in a second database without a name, which is gone with its process. It is the one
that is read. Programs under test can write to any file of the project: the file is looked at in each
transaction and at the end, and made anew if it is not what was written.

A file may come from anybody. A view or a trigger in it would be evaluated with each question: only the tables
of this version may be there.
"""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Self

from mutabot.errors import JournalError
from mutabot.model.codec import printable

from .files import WriterLock, previous_of, refuse_tracked

SCHEMA_VERSION = 8

TABLES = f"""
PRAGMA user_version = {SCHEMA_VERSION};
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE test (
    round INTEGER NOT NULL, repetition INTEGER NOT NULL, test TEXT NOT NULL, outcome TEXT NOT NULL,
    data TEXT NOT NULL, PRIMARY KEY (round, repetition, test));
CREATE TABLE mutant (number INTEGER NOT NULL, id TEXT PRIMARY KEY, data TEXT NOT NULL);
CREATE TABLE left_out (id TEXT NOT NULL, reason TEXT NOT NULL, data TEXT NOT NULL);
CREATE TABLE source (file TEXT PRIMARY KEY, text TEXT NOT NULL);
CREATE TABLE outcome (
    mutant TEXT NOT NULL, round INTEGER NOT NULL, verdict TEXT NOT NULL, "by" TEXT, data TEXT NOT NULL,
    key TEXT NOT NULL, reused INTEGER NOT NULL);
CREATE INDEX outcome_of ON outcome (mutant, round);
CREATE TABLE control (
    test_file TEXT NOT NULL, control TEXT NOT NULL, ok INTEGER NOT NULL, detail TEXT NOT NULL);
CREATE TABLE kept (
    mutant TEXT NOT NULL, round INTEGER NOT NULL, verdict TEXT NOT NULL, "by" TEXT, data TEXT NOT NULL,
    key TEXT NOT NULL, PRIMARY KEY (mutant, round));
CREATE TABLE parts (digest TEXT PRIMARY KEY, data TEXT NOT NULL);
CREATE TABLE known (id TEXT PRIMARY KEY, data TEXT NOT NULL, outdated INTEGER NOT NULL);
CREATE TABLE text (digest TEXT PRIMARY KEY, data BLOB NOT NULL);
"""
#: the rows that hold the last outcome of each mutant and round
LAST = "SELECT max(rowid) FROM outcome GROUP BY mutant, round"
#: what SQLite says where it is the disk that cannot take what is written, and not the file that is wrong
_OF_THE_DISK = ("full", "readonly", "disk I/O", "unable to open")
#: what a database consists of while somebody has it open
_SUFFIXES = ("", "-wal", "-shm")
#: things in a file that are looked at: a journal has fewer; rows, characters and rounds that are shown
_MOST, _SHOWN, _LONGEST, _MOST_ROUNDS = 100, 5, 150, 1_000_000
#: what people call rows of a table
_WORDS = {
    "meta": "fact", "test": "test of the baseline", "left_out": "mutant that was left out",
    "kept": "earlier outcome", "known": "earlier mutant",
}  # fmt: skip
_THINGS = "SELECT type, name, sql FROM main.sqlite_master LIMIT ?"


@cache
def _made() -> frozenset[tuple[str, str, str | None]]:
    """The tables and indexes that this version makes."""
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.executescript(TABLES)
        return frozenset(connection.execute(_THINGS, (_MOST,)))


@cache
def columns() -> dict[str, tuple[str, ...]]:
    """The tables and their columns."""
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.executescript(TABLES)
        tables = [name for kind, name, _ in _made() if kind == "table"]
        info = {name: connection.execute(f"PRAGMA table_info({name})").fetchall() for name in sorted(tables)}
    return {name: tuple(row[1] for row in rows) for name, rows in info.items()}


# Connections


def decode(text: bytes) -> str:
    """Text of a database, also such as is no UTF-8: that is for whoever knows what it should be."""
    return text.decode("utf-8", "surrogateescape")


def _open(name: str, pragmas: tuple[str, ...], *, uri: bool = False) -> sqlite3.Connection:
    # The writer may hand the journal from one thread to another; it never uses it from two at once.
    connection = sqlite3.connect(name, uri=uri, isolation_level=None, check_same_thread=False, timeout=10)
    connection.text_factory = decode
    try:
        for pragma in ("trusted_schema = OFF", *pragmas):
            connection.execute(f"PRAGMA {pragma}")
    except sqlite3.Error:
        connection.close()
        raise
    return connection


def connect(path: Path) -> sqlite3.Connection:
    """A connection that writes; the file is made if it does not exist."""
    # WAL lets readers work beside the writer. NORMAL survives the death of the process; only a power cut
    # can take the last outcomes, and those are simply run again.
    return _open(f"{path}", ("journal_mode = WAL", "synchronous = NORMAL"))


def loaded(source: sqlite3.Connection) -> sqlite3.Connection:
    """All that is in a database, in one without a name, which is gone with its connection."""
    copy = _open("", ())
    try:
        source.backup(copy)
        copy.execute("PRAGMA journal_mode = MEMORY")
        copy.execute("PRAGMA synchronous = OFF")
    except BaseException:
        copy.close()
        raise
    return copy


def connect_to_read(path: Path) -> sqlite3.Connection:
    """A connection that only reads."""

    def opened(file: Path) -> sqlite3.Connection:
        return _open(f"{file.absolute().as_uri()}?mode=ro", ("schema_version",), uri=True)

    try:
        return opened(path)
    except sqlite3.OperationalError:
        # In a folder we cannot write to, SQLite cannot make the index of a WAL journal: read a copy. What is
        # open can be read when it has no name any more.
        with TemporaryDirectory(prefix="mutabot-journal-") as folder:
            for part in (path, path.with_name(f"{path.name}-wal")):
                if part.is_file():
                    (Path(folder) / part.name).write_bytes(part.read_bytes())
            return opened(Path(folder) / path.name)


def write_anew(copy: sqlite3.Connection, path: Path) -> None:
    """Make a file of all that is in a database, and put it in the place of whatever is there."""
    new = path.with_name(f"{path.name}.new")
    new.unlink(missing_ok=True)
    try:
        with closing(sqlite3.connect(new)) as target:
            copy.backup(target)
        for suffix in _SUFFIXES[1:]:  # they are of the other file: SQLite would read them into this one
            path.with_name(path.name + suffix).unlink(missing_ok=True)
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        new.replace(path)
    finally:
        new.unlink(missing_ok=True)


@contextmanager
def guarded(path: Path) -> Iterator[None]:
    """Turn what goes wrong with the file at ``path`` into a JournalError."""
    try:
        yield
    except sqlite3.DatabaseError as error:
        text = str(error)
        if "not a database" in text or "malformed" in text:
            text = f"{path} is not a journal of mutabot ({text})"
        elif "readonly" in text or "unable to open" in text:
            text = f"{path} cannot be written: is the folder read-only? ({text})"
        elif "full" in text:
            text = f"{path} cannot be written: the disk is full; what was written before is kept ({text})"
        else:
            text = f"{path}: {text}"
        raise JournalError(text) from error
    except OSError as error:
        raise JournalError(f"{path}: {error.strerror or error}") from error


# What others did


def _rows(connection: sqlite3.Connection, table: str) -> dict[int, tuple[Any, ...]]:
    """The rows of a table by their numbers."""
    found = connection.execute(f"SELECT rowid, * FROM main.{table}")
    return {row: tuple(values) for row, *values in found}


def _differences(file: sqlite3.Connection, known: sqlite3.Connection) -> list[str]:
    """Rows that were changed, added or removed, and whatever else is in the file, in words."""
    if set(file.execute(_THINGS, (_MOST,))) != set(known.execute(_THINGS, (_MOST,))):
        return ["the tables are others than were made"]
    found: list[str] = []
    for table in columns():
        theirs, ours = _rows(file, table), _rows(known, table)
        for row in sorted(theirs.keys() | ours.keys()):
            # by what they look like: what is no number is not equal to itself
            if repr(theirs.get(row)) != repr(ours.get(row)):
                what = "added" if row not in ours else "removed" if row not in theirs else "changed"
                found.append(f"{named_row(table, ours.get(row) or theirs[row])} was {what}")
    return [*found[:_SHOWN], f"and {len(found) - _SHOWN} more"] if len(found) > _SHOWN else found


def named_row(table: str, values: tuple[Any, ...]) -> str:
    """What people know a row by; of the values, the first may do."""
    known = dict(zip(columns()[table], values, strict=False))
    name = next((known[one] for one in ("mutant", "id", "key", "file", "test") if one in known), values[0])
    text = name if isinstance(name, str) else repr(name)
    shown = repr(text[:_LONGEST].encode("utf-8", "replace").decode())[1:-1]
    round = known.get("round") if table in ("outcome", "kept") else None
    where = f" in round {round + 1}" if isinstance(round, int) and 0 <= round < _MOST_ROUNDS else ""
    return f"{_WORDS.get(table, table)} {shown}{where}"


# The file


class Database:
    """What is in a journal, in a database that nobody else can write; with the file of its writer.

    Every method raises JournalError when the file cannot be read or written.

    Attributes:
        path: the file.
        is_new: whether there was nothing in the file, and nothing is as yet.
        lost: how often the file was deleted or replaced, in words, and was written again.
        altered: rows of the file that somebody else changed, added or removed, and that were restored.
    """

    def __init__(self, path: Path, copy: sqlite3.Connection) -> None:
        self.path, self.copy = path, copy
        self.lost: list[str] = []
        self.altered: list[str] = []
        self.is_new = False
        self._file: sqlite3.Connection | None = None
        self._lock: WriterLock | None = None
        self._done: list[tuple[str, tuple[Any, ...]]] | None = None  # in a transaction
        self._identity, self._version = (0, 0), -1

    @classmethod
    def to_read(cls, path: Path) -> Self:
        """What is now in an existing journal of this version."""
        if not path.is_file():
            raise no_journal(path)
        refuse_tracked(path)
        with guarded(path):
            with closing(connect_to_read(path)) as file:
                found = cls(path, loaded(file))
            with found.closed_on_error():
                check_schema(path, found.copy)
                found.copy.execute("PRAGMA query_only = ON")
        return found

    @classmethod
    def to_write(cls, path: Path, lock: WriterLock) -> Self:
        """Open a journal to write it, whatever is in it; the file is made if there is none."""
        with guarded(path):
            file = connect(path)
            try:
                found = cls(path, loaded(file))
            except BaseException:
                file.close()
                raise
            found._file, found._lock = file, lock
            with found.closed_on_error():
                # the first transaction brings the tables into the file, with what is in them
                found.is_new = not found.rows("SELECT count(*) FROM sqlite_master")[0][0]
                if found.is_new:
                    found.copy.executescript(TABLES)
                else:
                    found._know_file()
        return found

    def close(self) -> None:
        """Close the file; the lock of a writer is given back."""
        self.copy.close()
        if self._file is not None and self._lock is not None:
            self._file.close()
            self._lock.release()

    @contextmanager
    def closed_on_error(self) -> Iterator[None]:
        """Close the file if what is done meanwhile fails."""
        try:
            yield
        except BaseException:
            self.close()
            raise

    def rows(self, statement: str, *values: Any) -> list[Any]:
        """What a question is answered with."""
        with guarded(self.path):
            return self.copy.execute(statement, _stored(values)).fetchall()

    def write(self, statement: str, *values: Any) -> None:
        """Carry out one statement; within ``transaction``, as a part of it."""
        if self._done is None:
            with self.transaction():
                self.write(statement, *values)
            return
        given = _stored(values)
        with guarded(self.path):
            self.copy.execute(statement, given)
        self._done.append((statement, given))

    @contextmanager
    def transaction(self, *, whole: bool = False) -> Iterator[None]:
        """What is written meanwhile takes effect together or not at all, in both databases.

        Before, the file is compared with what was written if somebody else wrote, and row by row if it is to
        be ``whole``; after, it is written again if it is not so.
        """
        assert self._file is not None
        with guarded(self.path):
            is_ours = False
            with self._noted():
                self._file.execute("BEGIN IMMEDIATE")  # from here on nobody else can write
                is_ours = not self.is_new and self._is_ours(whole)
            self.copy.execute("BEGIN")
            try:
                self._done = []
                yield
                if is_ours:
                    is_ours = self._repeat_in_file(self._done)
                self.copy.execute("COMMIT")
            except BaseException:
                self.copy.rollback()
                raise
            finally:
                self._done = None
                with suppress(sqlite3.Error):
                    self._file.rollback()
            if not is_ours:
                self._restore()

    def _repeat_in_file(self, done: list[tuple[str, tuple[Any, ...]]]) -> bool:
        """Write into the file what was written; returns whether it is there."""
        assert self._file is not None
        with self._noted():
            for statement, values in done:
                self._file.execute(statement, values)
            self._file.execute("COMMIT")
            return True
        return False

    @contextmanager
    def _noted(self) -> Iterator[None]:
        """Go on without the file if it is not as it should be, and say so."""
        try:
            yield
        except sqlite3.Error as error:
            if any(text in str(error) for text in _OF_THE_DISK):
                raise
            if "locked" in str(error):
                self.lost.append("was locked by something else")
            else:
                self.altered.append(f"the file cannot be written any more ({error})")

    def _is_ours(self, whole: bool) -> bool:
        """Whether the file holds what was written; says what does not. ``whole``: every row is looked at."""
        assert self._file is not None
        try:
            is_there = _identity(self.path) == self._identity
        except OSError:
            is_there = False
        if not is_there:
            self.lost.append("was deleted or replaced")
            return False
        version = self._data_version()
        found: list[str] = []
        if whole or version != self._version:
            try:
                with closing(connect_to_read(self.path)) as file:
                    found = _differences(file, self.copy)
            except (sqlite3.Error, OSError) as error:
                found = [f"the file cannot be read any more ({error})"]
        self.altered += found
        self._version = version
        return not found

    def _data_version(self) -> int:
        """Changes when another connection changes something."""
        assert self._file is not None
        return int(self._file.execute("PRAGMA data_version").fetchone()[0])

    def _know_file(self) -> None:
        assert self._file is not None
        self._identity, self._version = _identity(self.path), self._data_version()

    def _restore(self) -> None:
        """Write the file anew, and put it in the place of whatever is there."""
        assert self._file is not None
        assert self._lock is not None
        with suppress(sqlite3.Error):
            self._file.close()
        self.path.parent.mkdir(parents=True, exist_ok=True)
        write_anew(self.copy, self.path)
        self._lock.renew()
        self._file, self.is_new = connect(self.path), False
        self._know_file()


def _stored(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """Values of a row, with texts that can be stored."""
    return tuple(printable(value) if isinstance(value, str) else value for value in values)


def _identity(path: Path) -> tuple[int, int]:
    found = path.lstat()
    return found.st_dev, found.st_ino


def check_schema(path: Path, connection: sqlite3.Connection) -> None:
    """Raise JournalError if this is no journal of this version."""
    found = set(connection.execute(_THINGS, (_MOST,)))
    if not found:  # of a campaign that was killed before it had begun
        raise no_journal(path)
    tables = {name for kind, name, _ in found if kind == "table"}
    if not {"meta", "outcome"} <= tables:
        raise JournalError(f"{path} is a database, but not a journal of mutabot")
    strange = sorted(f"{kind} {name}" for kind, name, _ in found - _made())
    version = connection.execute("PRAGMA main.user_version").fetchone()[0]
    if version != SCHEMA_VERSION:
        raise JournalError(
            f"{path} was written by another version of mutabot (journal version {version or '6 or older'}, "
            f"this one reads {SCHEMA_VERSION}); run the campaign again",
            version=version,
        )
    if strange or _made() - found:
        what = f"holds what no journal has ({', '.join(strange[:3])})" if strange else "lacks a table"
        raise JournalError(
            f"{path} {what}, so something else than mutabot has changed it; run the campaign again"
        )


def no_journal(path: Path) -> JournalError:
    """There is nothing there."""
    return JournalError(f"{path}: there is no journal yet; `mutabot run` writes it")


def make_way(path: Path) -> Path | None:
    """Move aside what lies there and is no journal of this version; returns where to.

    A journal of another version gets that as part of its name, so that no later campaign overwrites it;
    a damaged one takes the place of the previous one. Raises JournalError for a file that is not ours.
    """
    for half in (path, previous_of(path)):  # of a campaign that was killed meanwhile
        half.with_name(f"{half.name}.new").unlink(missing_ok=True)
    if not path.exists():
        return None
    with path.open("rb") as file:
        start = file.read(16)
    if start and not start.startswith(b"SQLite format 3"):
        raise JournalError(f"{path} is in the way: it is not a journal of mutabot")
    kept = previous_of(path)
    try:
        with closing(connect(path)) as connection:
            if connection.execute("SELECT 1 FROM sqlite_master").fetchone() is None:
                return None  # of a campaign that was killed before it had begun
            check_schema(path, connection)
            if connection.execute("PRAGMA quick_check(1)").fetchone() == ("ok",):
                return None
    except JournalError as error:
        if error.version is not None:
            name = f"version-{error.version}" if error.version else "older"
            kept = path.with_name(f"{path.stem}.{name}{path.suffix}")
    except sqlite3.OperationalError:
        raise  # it is not the content that is wrong: a full disk, a folder that cannot be written
    except sqlite3.DatabaseError:
        pass
    for suffix in _SUFFIXES:
        old, new = path.with_name(path.name + suffix), kept.with_name(kept.name + suffix)
        new.unlink(missing_ok=True)
        if old.exists():
            old.replace(new)
    return kept
