"""The SQLite file of a journal: its tables, how it is opened, and changes by others.

Most tables hold one object a row, as the JSON of its ``data``; the columns beside it are for SQL to ask by.

A file may come from a stranger. A view or a trigger in it would be evaluated with each question: only the
tables of this version may be there.

While it is written, programs under test can do anything to it. A shared index of the log would be mapped into
memory, and a process that shortens it would end this one. So the writer keeps its index to itself, and
readers take a copy. It takes no lock that others could hold: ``files.WriterLock`` keeps other writers out.
"""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from mutabot.errors import JournalError
from mutabot.model.codec import printable
from mutabot.model.files import copy_file, read_file

from .files import BESIDE, clear, previous_of

SCHEMA_VERSION = 10

TABLES = f"""
PRAGMA user_version = {SCHEMA_VERSION};
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE test (name TEXT NOT NULL, data TEXT NOT NULL);
CREATE TABLE mutant (id TEXT PRIMARY KEY, data TEXT NOT NULL);
CREATE TABLE left_out (id TEXT NOT NULL, data TEXT NOT NULL);
CREATE TABLE source (file TEXT PRIMARY KEY, text TEXT NOT NULL);
CREATE TABLE outcome (
    mutant TEXT NOT NULL, round INTEGER NOT NULL, verdict TEXT NOT NULL, data TEXT NOT NULL,
    key TEXT NOT NULL, reused INTEGER NOT NULL);
CREATE INDEX outcome_of ON outcome (mutant, round);
CREATE TABLE control (name TEXT NOT NULL, data TEXT NOT NULL);
CREATE TABLE kept (
    mutant TEXT NOT NULL, round INTEGER NOT NULL, verdict TEXT NOT NULL, data TEXT NOT NULL,
    key TEXT NOT NULL, PRIMARY KEY (mutant, round));
CREATE TABLE parts (digest TEXT PRIMARY KEY, data TEXT NOT NULL);
CREATE TABLE known (id TEXT PRIMARY KEY, data TEXT NOT NULL, outdated INTEGER NOT NULL);
CREATE TABLE text (digest TEXT PRIMARY KEY, data BLOB NOT NULL);
CREATE TABLE original (task TEXT NOT NULL, data TEXT NOT NULL, events BLOB NOT NULL);
"""
#: the rows that hold the last outcome of each mutant and round
LAST = "SELECT max(rowid) FROM outcome GROUP BY mutant, round"
#: the index of the log is the connection's own
_ALONE = "locking_mode = EXCLUSIVE"
#: bytes with which a log begins, which are others as soon as it begins anew; copies that are tried
_HEAD, _TRIES = 32, 20
#: things in a file that are looked at: a journal has fewer; rows, characters and rounds that are shown
_MOST, _SHOWN, _LONGEST, _MOST_ROUNDS = 100, 5, 150, 1_000_000
#: what people call rows of a table
_WORDS = {
    "meta": "fact", "test": "test of the baseline", "left_out": "mutant that was left out",
    "kept": "earlier outcome", "known": "earlier mutant", "original": "run of the original",
}  # fmt: skip
_THINGS = "SELECT type, name, sql FROM main.sqlite_master LIMIT ?"


@cache
def _made() -> frozenset[tuple[str, str, str | None]]:
    """Return the tables and indexes of this version."""
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.executescript(TABLES)
        return frozenset(connection.execute(_THINGS, (_MOST,)))


@cache
def columns() -> dict[str, tuple[str, ...]]:
    """Return the tables and their columns."""
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.executescript(TABLES)
        tables = [name for kind, name, _ in _made() if kind == "table"]
        info = {name: connection.execute(f"PRAGMA table_info({name})").fetchall() for name in sorted(tables)}
    return {name: tuple(row[1] for row in rows) for name, rows in info.items()}


# Connections


def decode(text: bytes) -> str:
    """Decode a text of the database, keeping bytes that are no UTF-8 for callers that expect them."""
    return text.decode("utf-8", "surrogateescape")


def _open(name: str, pragmas: tuple[str, ...], *, uri: bool = False) -> sqlite3.Connection:
    # The writer may hand the journal from one thread to another; it never uses it from two at once.
    connection = sqlite3.connect(name, uri=uri, isolation_level=None, check_same_thread=False)
    connection.text_factory = decode
    try:
        for pragma in ("trusted_schema = OFF", *pragmas):
            connection.execute(f"PRAGMA {pragma}")
    except sqlite3.Error:
        connection.close()
        raise
    return connection


def connect(path: Path) -> sqlite3.Connection:
    """Open a connection for writing; the file is created if it does not exist."""
    # NORMAL survives the death of the process; only a power cut can take the last outcomes, and those are
    # simply run again. The last question opens the log, whatever is in its place later.
    pragmas = (_ALONE, "journal_mode = WAL", "synchronous = NORMAL", "schema_version")
    return _open(f"{path.absolute().as_uri()}?vfs=unix-none", pragmas, uri=True)


def loaded(source: sqlite3.Connection) -> sqlite3.Connection:
    """Copy a database into an unnamed one, which is deleted with its connection."""
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
    """Open a connection to the current content that creates, changes and locks nothing. Raises OSError."""
    log = path.with_name(f"{path.name}-wal")
    if not log.exists():  # no process writes
        return _open(f"{path.absolute().as_uri()}?immutable=1", ("schema_version",), uri=True)
    # what is open can be read when it has no name any more
    with TemporaryDirectory(prefix="mutabot-journal-") as folder:
        copy = Path(folder) / path.name
        for _ in range(_TRIES):
            before = _generation(path, log)
            for part in (path, log):
                with suppress(FileNotFoundError):  # it has been written anew, and there is no log any more
                    copy_file(part, copy.with_name(part.name))
            if _generation(path, log) == before:
                break
        return _open(f"{copy}", (_ALONE, "schema_version"))


def _generation(path: Path, log: Path) -> tuple[tuple[int, int], bytes]:
    """Return the log's generation: while it is unchanged, copies of the log match the file."""
    found = path.lstat()
    return (found.st_dev, found.st_ino), read_file(log, _HEAD) if log.exists() else b""


def stamps(path: Path) -> list[tuple[int, int, int, int] | None]:
    """Return values that change when a database or its log is written or replaced."""
    found: list[tuple[int, int, int, int] | None] = []
    for part in (path, path.with_name(f"{path.name}-wal")):
        try:
            status = part.lstat()
        except OSError:
            found.append(None)
        else:
            found.append((status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns))
    return found


def write_anew(copy: sqlite3.Connection, path: Path) -> None:
    """Write all of a database to a file, replacing whatever is there."""
    new = path.with_name(f"{path.name}.new")
    clear(new)
    try:
        with closing(sqlite3.connect(new)) as target:
            copy.backup(target)
        for suffix in BESIDE[1:]:  # they are of the other file: SQLite would read them into this one
            clear(path.with_name(path.name + suffix))
        if path.is_dir():
            clear(path)
        new.replace(path)
    finally:
        new.unlink(missing_ok=True)


# What others did


def _rows(connection: sqlite3.Connection, table: str) -> dict[int, tuple[Any, ...]]:
    """Return the rows of a table by their numbers."""
    found = connection.execute(f"SELECT rowid, * FROM main.{table}")
    return {row: tuple(values) for row, *values in found}


def row_differences(file: sqlite3.Connection, known: sqlite3.Connection) -> list[str]:
    """Return one text for each row that was changed, added or removed, and for other differences."""
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
    """Return the name by which people know a row; the first of the values if it has none."""
    known = dict(zip(columns()[table], values, strict=False))
    name = next((known[key] for key in ("mutant", "id", "key", "file", "test") if key in known), values[0])
    text = name if isinstance(name, str) else repr(name)
    shown = repr(text[:_LONGEST].encode("utf-8", "replace").decode())[1:-1]
    round = known.get("round") if table in ("outcome", "kept") else None
    where = f" in round {round + 1}" if isinstance(round, int) and 0 <= round < _MOST_ROUNDS else ""
    return f"{_WORDS.get(table, table)} {shown}{where}"


# What is there


def check_schema(path: Path, connection: sqlite3.Connection) -> None:
    """Raise JournalError if the database is no journal of this version."""
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
    """Return the error for a missing journal."""
    return JournalError(f"{path}: there is no journal yet; `mutabot run` writes it")


def set_aside(path: Path) -> Path | None:
    """Move aside a file that is no journal of this version; return its new path.

    A journal of another version gets that as part of its name, so that no later campaign overwrites it;
    a damaged one takes the place of the previous one. Raises JournalError for a file that is not ours.
    """
    for half in (path, previous_of(path)):  # of a campaign that was killed meanwhile
        clear(half.with_name(f"{half.name}.new"))
    if not path.exists():
        return None
    start = read_file(path.resolve(), 16)
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
    for suffix in BESIDE:
        old, new = path.with_name(path.name + suffix), kept.with_name(kept.name + suffix)
        clear(new)
        if os.path.lexists(old):
            old.replace(new)
    return kept


@contextmanager
def guarded(path: Path) -> Iterator[None]:
    """Turn errors with the file at ``path`` into a JournalError."""
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


def stored(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the values of a row, with texts that can be stored."""
    return tuple(printable(value) if isinstance(value, str) else value for value in values)
