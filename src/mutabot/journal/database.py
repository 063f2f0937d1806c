"""SQLite as the journal needs it: its tables, one writer, readers beside it, errors that say what to do."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from mutabot.errors import JournalError
from mutabot.model.codec import printable

SCHEMA_VERSION = 5

TABLES = """
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
CREATE TABLE mark (
    "table" TEXT NOT NULL, row INTEGER NOT NULL, digest BLOB NOT NULL, PRIMARY KEY ("table", row)
) WITHOUT ROWID;
"""
#: the tables with rows of their own, and their columns; ``mark`` holds a digest of each row
COLUMNS = {
    "meta": ("key", "value"),
    "test": ("round", "repetition", "test", "outcome", "data"),
    "mutant": ("number", "id", "data"),
    "left_out": ("id", "reason", "data"),
    "source": ("file", "text"),
    "outcome": ("mutant", "round", "verdict", "by", "data", "key", "reused"),
    "control": ("test_file", "control", "ok", "detail"),
    "kept": ("mutant", "round", "verdict", "by", "data", "key"),
    "parts": ("digest", "data"),
    "known": ("id", "data", "outdated"),
    "text": ("digest", "data"),
}
#: the rows that hold the last outcome of each mutant and round
LAST = "SELECT max(rowid) FROM outcome GROUP BY mutant, round"
#: what ``reused`` says of an outcome: found by this campaign, or known from another
FOUND, KNOWN_BEFORE = 0, 1
#: from one campaign to the next
ADOPT = f"""
INSERT OR REPLACE INTO known SELECT id, data, 1 FROM mutant;
INSERT OR REPLACE INTO kept
    SELECT mutant, round, verdict, "by", data, key FROM outcome
    WHERE rowid IN ({LAST});
DELETE FROM meta;
DELETE FROM test;
DELETE FROM mutant;
DELETE FROM left_out;
DELETE FROM source;
DELETE FROM outcome;
DELETE FROM control
"""
_OUTCOMES = f'SELECT mutant, round, verdict, "by", data, key, reused FROM outcome WHERE rowid IN ({LAST})'
#: from one journal to another: what is asked there, and what is done with each row here; the first counts
TAKE = {
    f"{_OUTCOMES} ORDER BY rowid":
        "INSERT INTO outcome SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7 "
        "WHERE NOT EXISTS (SELECT 1 FROM outcome WHERE mutant = ?1 AND round = ?2)",
    "SELECT test_file, control, ok, detail FROM control ORDER BY rowid":
        "INSERT INTO control SELECT ?1, ?2, ?3, ?4 WHERE NOT EXISTS "
        "(SELECT 1 FROM control WHERE test_file = ?1 AND control = ?2 AND ok = ?3)",
    "SELECT * FROM parts": "INSERT OR IGNORE INTO parts VALUES (?, ?)",
    "SELECT * FROM text": "INSERT OR IGNORE INTO text VALUES (?, ?)",
    "SELECT * FROM kept": "INSERT OR IGNORE INTO kept VALUES (?, ?, ?, ?, ?, ?)",
}  # fmt: skip
# Keys of meta that are the journal's own; the others are the campaign's.
VERSION_KEY, FINISHED_KEY = "journal:version", "journal:finished"
#: of a campaign that has not begun yet: why it ended, null as long as it has not
ATTEMPT_KEY = "journal:attempt"


#: what Python and SQLite raise because of one row, and not because of the file
OF_ONE_ROW = (
    sqlite3.DataError, sqlite3.InterfaceError, sqlite3.ProgrammingError, sqlite3.IntegrityError,
    OverflowError, ValueError, TypeError,
)  # fmt: skip
#: what a database consists of while somebody has it open
SUFFIXES = ("", "-wal", "-shm")
#: carries out one statement with its values
Execute = Callable[..., sqlite3.Cursor]


def decode(text: bytes) -> str:
    """Text of a database, also such as is no UTF-8: that is for whoever knows what it should be."""
    return text.decode("utf-8", "surrogateescape")


def stored(values: Iterable[Any]) -> tuple[Any, ...]:
    """Values of a row, with texts that can be stored."""
    return tuple(printable(value) if isinstance(value, str) else value for value in values)


def connect(path: Path) -> sqlite3.Connection:
    """A connection that writes; the file is made if it does not exist."""
    # The writer may hand the journal from one thread to another; it never uses it from two at once.
    connection = sqlite3.connect(path, isolation_level=None, check_same_thread=False, timeout=10)
    connection.text_factory = decode
    # WAL lets readers work beside the writer. NORMAL survives the death of the process; only a power cut
    # can take the last outcomes, and those are simply run again.
    try:
        connection.execute("PRAGMA trusted_schema = OFF")
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = NORMAL")
    except sqlite3.Error:
        connection.close()
        raise
    return connection


def loaded(source: sqlite3.Connection) -> sqlite3.Connection:
    """All that is in a database, in one without a name, which is gone with its connection."""
    copy = sqlite3.connect("", isolation_level=None, check_same_thread=False)
    copy.text_factory = decode
    try:
        source.backup(copy)
        copy.execute("PRAGMA trusted_schema = OFF")
        copy.execute("PRAGMA journal_mode = MEMORY")
        copy.execute("PRAGMA synchronous = OFF")
    except BaseException:
        copy.close()
        raise
    return copy


def connect_to_read(path: Path) -> sqlite3.Connection:
    """A connection that only reads."""
    try:
        return _connect_read_only(path)
    except sqlite3.OperationalError:
        # In a folder we cannot write to, SQLite cannot make the index of a WAL journal: read a copy. What is
        # open can be read when it has no name any more.
        with TemporaryDirectory(prefix="mutabot-journal-") as folder:
            for part in (path, path.with_name(f"{path.name}-wal")):
                if part.is_file():
                    (Path(folder) / part.name).write_bytes(part.read_bytes())
            return _connect_read_only(Path(folder) / path.name)


def _connect_read_only(path: Path) -> sqlite3.Connection:
    uri = f"{path.absolute().as_uri()}?mode=ro"
    connection = sqlite3.connect(uri, uri=True, isolation_level=None, check_same_thread=False, timeout=10)
    connection.text_factory = decode
    try:
        connection.execute("PRAGMA trusted_schema = OFF")
        connection.execute("SELECT count(*) FROM sqlite_master")
    except sqlite3.Error:
        connection.close()
        raise
    return connection


def write_anew(copy: sqlite3.Connection, path: Path) -> None:
    """Make a file of all that is in a database, and put it in the place of whatever is there."""
    new = path.with_name(f"{path.name}.new")
    new.unlink(missing_ok=True)
    try:
        with closing(sqlite3.connect(new)) as target:
            copy.backup(target)
        for suffix in SUFFIXES[1:]:  # they are of the other file: SQLite would read them into this one
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
        raise JournalError(_explain(path, error), path=str(path)) from error
    except OSError as error:
        raise JournalError(f"{path}: {error.strerror or error}", path=str(path)) from error


def _explain(path: Path, error: sqlite3.DatabaseError) -> str:
    text = str(error)
    if "not a database" in text or "malformed" in text:
        return f"{path} is not a journal of mutabot ({text})"
    if "readonly" in text or "unable to open" in text:
        return f"{path} cannot be written: is the folder read-only? ({text})"
    if "full" in text:
        return f"{path} cannot be written: the disk is full; what was written before is kept ({text})"
    return f"{path}: {text}"
