"""The journal: one SQLite file with the plan, the baseline and every outcome of a campaign.

One process writes, any number read, also while it writes and after it was killed. Each record is on its
own and committed when it is added, so that a killed campaign loses nothing that was reported. All else
(reports, resuming, comparing) reads from here.

A new campaign begins in the same file: in one transaction the plan, the baseline and the outcomes of the
one before make way. Its mutants and outcomes are kept aside: outcomes that still hold are taken over, and
reports show those that a campaign of other mutants leaves alone.
"""

from __future__ import annotations

import errno
import json
import os
import sqlite3
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Self

from mutabot.border.codec import from_data, to_data
from mutabot.border.lines import TestEnd
from mutabot.errors import JournalError
from mutabot.model import LeftOut, Mutant, Outcome, Vocabulary

from .database import connect, connect_to_read, guarded
from .lock import WriterLock
from .records import BaselineTest, ControlEnd, Kept

SCHEMA_VERSION = 2

_SCHEMA = """
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
"""
_LAST = "SELECT max(rowid) FROM outcome GROUP BY mutant, round"
#: came later: journals of before are read without it
_KNOWN = (
    "CREATE TABLE IF NOT EXISTS known (id TEXT PRIMARY KEY, data TEXT NOT NULL, outdated INTEGER NOT NULL)"
)
#: from one campaign to the next
_ADOPT = f"""
{_KNOWN};
INSERT OR REPLACE INTO known SELECT id, data, 1 FROM mutant;
INSERT OR REPLACE INTO kept
    SELECT mutant, round, verdict, "by", data, key FROM outcome WHERE rowid IN ({_LAST});
DELETE FROM meta;
DELETE FROM test;
DELETE FROM mutant;
DELETE FROM left_out;
DELETE FROM source;
DELETE FROM outcome;
DELETE FROM control
"""
# Keys of meta that are the journal's own; the others are the campaign's.
_VERSION_KEY, _FINISHED_KEY = "journal:version", "journal:finished"
#: of a campaign that has not begun yet: why it ended, null as long as it has not
_ATTEMPT_KEY = "journal:attempt"


class Journal:
    """The record of one campaign; use as a context manager.

    Every method raises JournalError when the file cannot be read or written.

    Attributes:
        path: the file.
        key_of: tells what the outcome of a mutant in a round depends on; the empty key says that nobody
            knows, and that it is not to be reused.
    """

    def __init__(
        self,
        path: Path,
        connection: sqlite3.Connection,
        *,
        lock: WriterLock | None = None,
        copy: TemporaryDirectory[str] | None = None,
    ) -> None:
        self.path = path
        self.key_of: Callable[[str, int], str] = lambda mutant, round: ""
        self._connection, self._lock, self._copy = connection, lock, copy
        self._waits = False

    @classmethod
    def create(cls, path: Path, *, meta: Mapping[str, Any], fresh: bool = False) -> Journal:
        """``prepare`` and ``begin`` a campaign at once."""
        journal = cls.prepare(path, meta=meta)
        with journal._closed_on_error():
            if journal._waits:
                journal.begin(meta, fresh=fresh)
        return journal

    @classmethod
    def prepare(cls, path: Path, *, meta: Mapping[str, Any]) -> Journal:
        """Take the journal for a campaign that is to ``begin``; until then it is that of the one before.

        If there is none before, it has begun. What is no journal of this version is moved aside.

        Reports understand these keys of ``meta``, all optional: ``mutabot``, ``python``, ``versions`` (name
        to version), ``root``, ``seed``, ``rounds``, ``engine``, ``jobs``, ``started``, ``vocabulary`` (what
        ``to_data`` makes of one).
        """
        with guarded(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            lock = WriterLock.take(path)
            try:
                _remove(_half_a_copy_of(path))
                is_journal = _make_way(path)
                journal = cls(path, connect(path), lock=lock)
            except BaseException:
                lock.release()
                raise
            with journal._closed_on_error():
                if is_journal:
                    journal._wait()
                else:
                    journal._begin(meta, _SCHEMA)
        return journal

    def begin(self, meta: Mapping[str, Any], *, fresh: bool = False) -> None:
        """Begin the campaign. Mutants and outcomes of those before are kept aside.

        All or nothing. A complete campaign stays readable as ``previous_of`` the path. ``fresh``: none of the
        outcomes is to be reused.
        """
        if not self._waits:
            return  # nothing was there before
        with guarded(self.path):
            if self.finished == "complete":
                self._keep_copy()
            self._begin(meta, _ADOPT)
            self._waits = False
        if fresh:
            self._write("UPDATE kept SET key = ''")

    @classmethod
    def open(cls, path: Path, *, writable: bool = False) -> Journal:
        """Open an existing journal, to read it or (``writable``) to go on with it."""
        if not path.is_file():
            raise JournalError(f"{path}: there is no journal yet; `mutabot run` writes it", path=str(path))
        with guarded(path):
            journal = cls._open_to_write(path) if writable else cls._open_to_read(path)
            with journal._closed_on_error():
                journal._check_version()
        return journal

    @classmethod
    def _open_to_read(cls, path: Path) -> Journal:
        connection, copy = connect_to_read(path)
        return cls(path, connection, copy=copy)

    @classmethod
    def _open_to_write(cls, path: Path) -> Journal:
        lock = WriterLock.take(path)
        try:
            return cls(path, connect(path), lock=lock)
        except BaseException:
            lock.release()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; the lock of a writer is given back."""
        self._connection.close()
        if self._lock is not None:
            self._lock.release()
        if self._copy is not None:
            self._copy.cleanup()

    # What the campaign was and how it ended

    def meta(self) -> dict[str, Any]:
        """What the campaign said about itself."""
        rows = self._rows("SELECT key, value FROM meta")
        return {key: json.loads(value) for key, value in rows if not key.startswith("journal:")}

    def set_meta(self, key: str, value: Any) -> None:
        """Add or replace one fact about the campaign."""
        with guarded(self.path):
            self._put(key, value)

    @property
    def vocabulary(self) -> Vocabulary | None:
        """The vocabulary of the campaign, if it was written down."""
        data = self.meta().get("vocabulary")
        return from_data(Vocabulary, data) if data is not None else None

    def finish(self, reason: str) -> None:
        """Note that the campaign has ended: ``complete``, ``interrupted`` or why it stopped.

        If it has not even begun, the journal stays that of the one before, and tells about the attempt.
        """
        with guarded(self.path):
            self._put(_ATTEMPT_KEY if self._waits else _FINISHED_KEY, reason)

    @property
    def finished(self) -> str | None:
        """Why the campaign ended; None while it runs and after it was killed."""
        rows = self._rows("SELECT value FROM meta WHERE key = ?", _FINISHED_KEY)
        return str(json.loads(rows[0][0])) if rows else None

    @property
    def attempt(self) -> str | None:
        """Why a later campaign ended before it had begun; empty if it was killed or is about to begin.

        None if there was no such campaign.
        """
        rows = self._rows("SELECT value FROM meta WHERE key = ?", _ATTEMPT_KEY)
        return str(json.loads(rows[0][0]) or "") if rows else None

    def resume(self) -> None:
        """Note that a campaign that had ended goes on."""
        self._write("DELETE FROM meta WHERE key = ?", _FINISHED_KEY)

    # The baseline

    def add_test(self, round: int, repetition: int, test: TestEnd) -> None:
        """Add one test of the baseline; the same test again replaces it."""
        self._write(
            "INSERT OR REPLACE INTO test VALUES (?, ?, ?, ?, ?)",
            round, repetition, test.test, test.outcome, _dump(test),
        )  # fmt: skip

    def tests(self) -> list[BaselineTest]:
        """The tests of the baseline in the order they were added."""
        rows = self._rows("SELECT round, repetition, data FROM test ORDER BY rowid")
        return [
            BaselineTest(round, repetition, from_data(TestEnd, json.loads(data)))
            for round, repetition, data in rows
        ]

    # The plan

    def set_plan(
        self,
        mutants: Iterable[Mutant],
        left_out: Iterable[LeftOut],
        *,
        sources: Mapping[str, str] | None = None,
    ) -> None:
        """Write down the plan, whole or not at all; an older plan is replaced.

        ``sources`` holds the text of the files that mutants stand in, by their name in the spans, so that
        reports show what was mutated and not what became of it since.
        """
        with guarded(self.path), self._transaction() as execute:
            for table in ("mutant", "left_out", "source"):
                execute(f"DELETE FROM {table}")
            for mutant in mutants:
                execute("INSERT INTO mutant VALUES (?, ?, ?)", mutant.number, mutant.id, _dump(mutant))
            for item in left_out:
                execute("INSERT INTO left_out VALUES (?, ?, ?)", item.id, item.reason, _dump(item))
            for file, text in (sources or {}).items():
                execute("INSERT INTO source VALUES (?, ?)", file, text)

    def mutants(self) -> list[Mutant]:
        """The planned mutants by number."""
        return self._read(Mutant, "SELECT data FROM mutant ORDER BY number, rowid")

    def left_out(self) -> list[LeftOut]:
        """What the plan leaves out, in its order."""
        return self._read(LeftOut, "SELECT data FROM left_out ORDER BY rowid")

    def source(self, file: str) -> str | None:
        """The text of a mutated file at the time of the campaign, or None if it was not written down."""
        rows = self._rows("SELECT text FROM source WHERE file = ?", file)
        return str(rows[0][0]) if rows else None

    # Outcomes

    def add_outcome(self, outcome: Outcome) -> None:
        """Add one outcome; a later one of the same mutant and round takes its place."""
        self._write(
            "INSERT INTO outcome VALUES (?, ?, ?, ?, ?, ?, 0)",
            outcome.mutant, outcome.round, outcome.verdict.value, outcome.by.value if outcome.by else None,
            _dump(outcome), self.key_of(outcome.mutant, outcome.round),
        )  # fmt: skip

    def outcomes(self) -> list[Outcome]:
        """The last outcome of each (mutant, round), in the order they came."""
        return self._read(Outcome, f"SELECT data FROM outcome WHERE rowid IN ({_LAST}) ORDER BY rowid")

    def reused(self) -> set[tuple[str, int]]:
        """The mutants and rounds whose outcomes were taken over from an earlier campaign."""
        return set(self._rows(f"SELECT mutant, round FROM outcome WHERE reused AND rowid IN ({_LAST})"))

    # Outcomes of earlier campaigns

    def kept(self) -> dict[tuple[str, int], Kept]:
        """The last outcome of each mutant and round that earlier campaigns found, if it can be reused."""
        rows = self._rows(
            "SELECT mutant, round, key, verdict NOT IN ('error', 'unstable') AND data NOT LIKE ? FROM kept "
            "WHERE key != ''",
            f"%{os.strerror(errno.ENOSPC)}%",
        )
        return {(mutant, round): Kept(key, bool(sound)) for mutant, round, key, sound in rows}

    def kept_outcomes(self) -> list[Outcome]:
        """All that earlier campaigns found, also what cannot be reused."""
        return self._read(Outcome, "SELECT data FROM kept")

    def forget(self, mutants: Iterable[str]) -> None:
        """Never reuse what earlier campaigns found about these mutants."""
        with guarded(self.path), self._transaction() as execute:
            for mutant in mutants:
                execute("UPDATE kept SET key = '' WHERE mutant = ?", mutant)

    def known(self) -> list[tuple[Mutant, bool]]:
        """Mutants of earlier campaigns, and whether something has changed since that they depend on."""
        if not self._rows("SELECT 1 FROM sqlite_master WHERE name = 'known'"):
            return []
        rows = self._rows("SELECT data, outdated FROM known ORDER BY rowid")
        return [(from_data(Mutant, json.loads(data)), bool(outdated)) for data, outdated in rows]

    def set_known(self, known: Iterable[tuple[Mutant, bool]]) -> None:
        """Write down the mutants of earlier campaigns that the program still has."""
        with guarded(self.path), self._transaction() as execute:
            execute(_KNOWN)
            execute("DELETE FROM known")
            for mutant, outdated in known:
                execute("INSERT INTO known VALUES (?, ?, ?)", mutant.id, _dump(mutant), int(outdated))

    def reuse(self, pairs: Iterable[tuple[str, int]]) -> None:
        """Take over the kept outcomes of these mutants and rounds."""
        with guarded(self.path), self._transaction() as execute:
            for pair in pairs:
                execute(
                    'INSERT INTO outcome SELECT mutant, round, verdict, "by", data, key, 1 FROM kept '
                    "WHERE mutant = ? AND round = ?",
                    *pair,
                )

    def add_parts(self, parts: Mapping[str, Mapping[str, str]]) -> None:
        """Write down what digests in keys stand for."""
        if not parts:
            return
        with guarded(self.path), self._transaction() as execute:
            for digest, data in parts.items():
                execute("INSERT OR IGNORE INTO parts VALUES (?, ?)", digest, _dump(data))

    def parts(self, digest: str) -> dict[str, str] | None:
        """What a digest in a key stands for, or None if that is not known any more."""
        rows = self._rows("SELECT data FROM parts WHERE digest = ?", digest)
        return dict(json.loads(rows[0][0])) if rows else None

    def forget_keys(self) -> None:
        """Never reuse what this campaign has found itself."""
        self._write("UPDATE outcome SET key = '' WHERE NOT reused")

    def tidy(self, mutants: Iterable[str]) -> None:
        """Forget what earlier campaigns found about other mutants, and what nothing refers to."""
        with guarded(self.path), self._transaction() as execute:
            known = set(mutants)
            for (mutant,) in execute("SELECT DISTINCT mutant FROM kept").fetchall():
                if mutant not in known:
                    execute("DELETE FROM kept WHERE mutant = ?", mutant)
            keys = execute("SELECT key FROM kept UNION SELECT key FROM outcome").fetchall()
            needed = {digest for (key,) in keys for digest in key.split()}
            for (digest,) in execute("SELECT digest FROM parts").fetchall():
                if digest not in needed:
                    execute("DELETE FROM parts WHERE digest = ?", digest)

    # Controls

    def add_control(self, test_file: str, control: str, ok: bool, detail: str = "") -> None:
        """Add the end of one control mutant."""
        self._write("INSERT INTO control VALUES (?, ?, ?, ?)", test_file, control, int(ok), detail)

    def controls(self) -> list[ControlEnd]:
        """The controls in the order they were added."""
        rows = self._rows("SELECT test_file, control, ok, detail FROM control ORDER BY rowid")
        return [ControlEnd(file, control, bool(ok), detail) for file, control, ok, detail in rows]

    # Plumbing

    def _put(self, key: str, value: Any) -> None:
        self._connection.execute("INSERT OR REPLACE INTO meta VALUES (?, ?)", (key, _dump(value)))

    def _write(self, statement: str, *values: Any) -> None:
        with guarded(self.path):
            self._connection.execute(statement, values)

    def _rows(self, statement: str, *values: Any) -> list[Any]:
        with guarded(self.path):
            return self._connection.execute(statement, values).fetchall()

    def _read(self, kind: type[Any], statement: str) -> list[Any]:
        return [from_data(kind, json.loads(data)) for (data,) in self._rows(statement)]

    def _wait(self) -> None:
        """The campaign before this one has ended, whatever became of it; the next may fail to begin."""
        self._waits = True
        if self.finished is None:
            self._put(_FINISHED_KEY, "killed")
        self._put(_ATTEMPT_KEY, None)

    def _begin(self, meta: Mapping[str, Any], statements: str) -> None:
        with self._transaction() as execute:
            for statement in statements.split(";"):
                execute(statement)
            self._put(_VERSION_KEY, SCHEMA_VERSION)
            for key, value in meta.items():
                self._put(key, value)

    def _keep_copy(self) -> None:
        """Keep the campaign before this one as it is."""
        kept = previous_of(self.path)
        new = _half_a_copy_of(self.path)
        try:
            self._connection.execute("VACUUM INTO ?", (str(new),))
            _remove(kept)
            new.replace(kept)
        finally:
            new.unlink(missing_ok=True)

    @contextmanager
    def _closed_on_error(self) -> Iterator[None]:
        try:
            yield
        except BaseException:
            self.close()
            raise

    @contextmanager
    def _transaction(self) -> Iterator[Any]:
        self._connection.execute("BEGIN IMMEDIATE")
        try:
            yield lambda statement, *values: self._connection.execute(statement, values)
        except BaseException:
            if self._connection.in_transaction:  # SQLite itself rolls back when the disk is full
                self._connection.execute("ROLLBACK")
            raise
        self._connection.execute("COMMIT")

    def _check_version(self) -> None:
        path = str(self.path)
        tables = {name for (name,) in self._rows("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if not {"meta", "outcome"} <= tables:
            raise JournalError(f"{path} is a database, but not a journal of mutabot", path=path)
        rows = self._rows("SELECT value FROM meta WHERE key = ?", _VERSION_KEY)
        found = json.loads(rows[0][0]) if rows else None
        if found != SCHEMA_VERSION:
            raise JournalError(
                f"{path} was written by another version of mutabot (journal version {found}, this one reads "
                f"{SCHEMA_VERSION}); run the campaign again",
                path=path,
            )


def previous_of(path: Path) -> Path:
    """Where the last complete campaign before this journal's is kept: ``journal.previous.sqlite``."""
    return path.with_name(f"{path.stem}.previous{path.suffix}")


def _half_a_copy_of(path: Path) -> Path:
    return path.with_name(f"{previous_of(path).name}.new")


def _dump(value: Any) -> str:
    return json.dumps(to_data(value), ensure_ascii=False, default=str)


def _make_way(path: Path) -> bool:
    """Whether a journal of this version lies there; anything else that mutabot may replace is moved aside."""
    if not path.exists():
        return False
    with path.open("rb") as file:
        start = file.read(16)
    if start and not start.startswith(b"SQLite format 3"):
        raise JournalError(f"{path} is in the way: it is not a journal of mutabot", path=str(path))
    if _is_journal(path):
        return True
    if _is_empty(path):  # of a campaign that was killed before it had begun
        return False
    kept = previous_of(path)
    _remove(kept)
    for suffix in ("", "-wal", "-shm"):
        old = path.with_name(path.name + suffix)
        if old.exists():
            old.replace(kept.with_name(kept.name + suffix))
    return False


def _is_empty(path: Path) -> bool:
    with suppress(sqlite3.DatabaseError), closing(connect(path)) as connection:
        return connection.execute("SELECT 1 FROM sqlite_master").fetchone() is None
    return False


def _is_journal(path: Path) -> bool:
    try:
        with closing(connect(path)) as connection:
            Journal(path, connection)._check_version()
            (sound,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    except (JournalError, sqlite3.DatabaseError) as error:
        cause = error.__cause__ if isinstance(error, JournalError) else error
        if isinstance(cause, sqlite3.OperationalError):
            raise  # it is not the content that is wrong: a full disk, a folder that cannot be written
        return False
    return bool(sound == "ok")


def _remove(path: Path) -> None:
    for suffix in ("", "-wal", "-shm"):
        path.with_name(path.name + suffix).unlink(missing_ok=True)
