"""SQLite as the journal needs it: one writer, readers beside it, and errors that say what to do."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import RLock, Timer
from time import monotonic
from typing import Any

from mutabot.border.storable import printable
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

#: carries out one statement with its values
Execute = Callable[..., sqlite3.Cursor]
Transaction = AbstractContextManager[Execute]


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


class Batch:
    """Rows that are committed together, none later than ``PATIENCE`` seconds after it was added.

    The first after a pause is committed at once: a campaign whose outcomes come one by one waits for nothing.
    Of one whose outcomes come by the hundred, a commit for each would take most of the writing's time.

    Args:
        transaction: makes what is carried out in it take effect together or not at all.

    Attributes:
        lock: to be held by whoever uses the connection.
        unstored: why rows could not be stored, one line each, though the file can be written.
    """

    def __init__(
        self, transaction: Callable[[], Transaction], *, clock: Callable[[], float] = monotonic
    ) -> None:
        self.lock = RLock()
        self._transaction, self._clock = transaction, clock
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
            with self._transaction() as execute:
                for statement, values in waiting:
                    execute(statement, *values)
        except (sqlite3.Error, *_ABOUT_VALUES):
            for statement, values in waiting:
                self._carry_out_alone(statement, values)

    def _carry_out_alone(self, statement: str, values: tuple[Any, ...]) -> None:
        """One that fails takes no other with it."""
        try:
            with self._transaction() as execute:
                execute(statement, *values)
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
