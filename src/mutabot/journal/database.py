"""SQLite as the journal needs it: one writer, readers beside it, and errors that say what to do."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import RLock, Timer
from time import monotonic
from typing import Any, Protocol

from mutabot.errors import JournalError

#: seconds after which a row that was added is in the file, and how long it waits: timers may be late
WITHIN = 1.0
PATIENCE = WITHIN / 2
#: what Python raises for values that SQLite cannot take: beyond 64 bits, no UTF-8, of no type that it knows
_ABOUT_VALUES = (OverflowError, ValueError, TypeError)
#: what SQLite raises because of one row, and not because of the file
_OF_ONE_ROW = (sqlite3.DataError, sqlite3.InterfaceError, sqlite3.ProgrammingError, sqlite3.IntegrityError)
#: characters of a value that are shown
_SHOWN = 100


class Connection(Protocol):
    """What the journal needs of a connection."""

    @property
    def in_transaction(self) -> bool: ...

    def execute(self, statement: str, values: tuple[Any, ...] = ..., /) -> sqlite3.Cursor: ...

    def backup(self, target: sqlite3.Connection, /) -> None: ...

    def close(self) -> None: ...


def decode(text: bytes) -> str:
    """Text of a database, also such as is no UTF-8: that is for whoever knows what it should be."""
    return text.decode("utf-8", "surrogateescape")


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
    connection.text_factory = decode
    try:
        connection.execute("PRAGMA trusted_schema = OFF")
        connection.execute("SELECT count(*) FROM sqlite_master")
    except sqlite3.Error:
        connection.close()
        raise
    return connection


@contextmanager
def read_now(path: Path) -> Iterator[sqlite3.Connection]:
    """A connection that sees what is in the file now."""
    with closing(_connect_read_only(path)) as connection:
        yield connection


class Batch:
    """Rows that are committed together, none later than ``PATIENCE`` seconds after it was added.

    The first after a pause is committed at once: a campaign whose outcomes come one by one waits for nothing.
    Of one whose outcomes come by the hundred, a commit for each would take most of the writing's time.

    Attributes:
        lock: to be held by whoever uses the connection.
        unstored: why rows could not be stored, one line each, though the file can be written.
    """

    def __init__(self, connection: Connection, *, clock: Callable[[], float] = monotonic) -> None:
        self.lock = RLock()
        self._connection, self._clock = connection, clock
        self._waiting: list[tuple[str, tuple[Any, ...]]] = []
        self._committed = float("-inf")
        self._timer: Timer | None = None
        self._problem: sqlite3.Error | None = None
        self.unstored: list[str] = []

    def add(self, statement: str, *values: Any) -> None:
        """Have a statement carried out. Raises what SQLite did when statements before were."""
        with self.lock:
            self._raise()
            self._waiting.append((statement, values))
            if self._clock() - self._committed >= PATIENCE:
                self.commit()
            elif self._timer is None:
                self._timer = Timer(PATIENCE, self._commit_late)
                self._timer.daemon = True
                self._timer.start()

    def commit(self) -> None:
        """Carry out what waits. Raises what SQLite does, also what it did before."""
        with self.lock:
            if self._timer is not None:
                self._timer.cancel()
                self._timer = None
            waiting, self._waiting = self._waiting, []
            if waiting:
                self._carry_out(waiting)
                self._committed = self._clock()
            self._raise()

    def _carry_out(self, waiting: list[tuple[str, tuple[Any, ...]]]) -> None:
        try:
            self._connection.execute("BEGIN IMMEDIATE")
            for statement, values in waiting:
                self._connection.execute(statement, values)
            self._connection.execute("COMMIT")
        except (sqlite3.Error, *_ABOUT_VALUES):
            if self._connection.in_transaction:  # SQLite itself rolls back when the disk is full
                self._connection.execute("ROLLBACK")
            self._one_by_one(waiting)

    def _one_by_one(self, waiting: list[tuple[str, tuple[Any, ...]]]) -> None:
        """One that fails takes no other with it."""
        for statement, values in waiting:
            try:
                self._connection.execute(statement, values)
            except (*_OF_ONE_ROW, *_ABOUT_VALUES) as error:
                what = ", ".join(str(value)[:_SHOWN] for value in values[:2])
                self.unstored.append(f"{what}: {type(error).__name__}: {error}")
            except sqlite3.Error as error:
                self._problem = self._problem or error

    def _commit_late(self) -> None:
        """In a thread of its own: what goes wrong is told to whoever writes next."""
        with self.lock:
            if self._timer is not None:  # else somebody was quicker
                try:
                    self.commit()
                except sqlite3.Error as error:
                    self._problem = error

    def _raise(self) -> None:
        problem, self._problem = self._problem, None
        if problem is not None:
            raise problem


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
