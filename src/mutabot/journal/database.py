"""SQLite as the journal needs it: one writer, readers beside it, and errors that say what to do."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from mutabot.errors import JournalError


def connect(path: Path) -> sqlite3.Connection:
    """A connection that writes; the file is made if it does not exist."""
    # The writer may hand the journal from one thread to another; it never uses it from two at once.
    connection = sqlite3.connect(path, isolation_level=None, check_same_thread=False, timeout=10)
    # WAL lets readers work beside the writer. NORMAL survives the death of the process; only a power cut
    # can take the last outcomes, and those are simply run again.
    try:
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = NORMAL")
    except sqlite3.Error:
        connection.close()
        raise
    return connection


def connect_to_read(path: Path) -> tuple[sqlite3.Connection, TemporaryDirectory[str] | None]:
    """A connection that only reads, and the folder of the copy that it reads, if it needed one."""
    try:
        return _connect_read_only(path), None
    except sqlite3.OperationalError:
        # In a folder we cannot write to, SQLite cannot make the index of a WAL journal: read a copy.
        copy = TemporaryDirectory(prefix="mutabot-journal-")
        try:
            for part in (path, path.with_name(f"{path.name}-wal")):
                if part.is_file():
                    (Path(copy.name) / part.name).write_bytes(part.read_bytes())
            return _connect_read_only(Path(copy.name) / path.name), copy
        except BaseException:
            copy.cleanup()
            raise


def _connect_read_only(path: Path) -> sqlite3.Connection:
    uri = f"{path.absolute().as_uri()}?mode=ro"
    connection = sqlite3.connect(uri, uri=True, isolation_level=None, check_same_thread=False, timeout=10)
    try:
        connection.execute("SELECT count(*) FROM sqlite_master")
    except sqlite3.Error:
        connection.close()
        raise
    return connection


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
        return f"{path} cannot be written: the disk is full; what was reported before is kept ({text})"
    return f"{path}: {text}"
