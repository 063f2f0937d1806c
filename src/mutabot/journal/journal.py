"""The journal: one SQLite file with the plan, the baseline and every outcome of a campaign.

One process writes, any number read, also while it writes and after it was killed. What is added is
committed at once: a campaign that is killed loses nothing that it had found. All else (reports, resuming,
comparing) reads from here.

What the writer knows is in a second database without a name, which is gone with its process. It is the one
that is read. Programs under test can write to any file of the project: the file is looked at in each
transaction and at the end, and made anew if it is not what was written.

A new campaign begins in the same file: in one transaction the plan, the baseline and the outcomes of the
one before make way. Its mutants and outcomes are kept aside: outcomes that still hold are taken over, and
reports show those that a campaign of other mutants leaves alone.
"""

from __future__ import annotations

import errno
import json
import os
import sqlite3
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Self, TypeVar

from mutabot.errors import JournalError
from mutabot.model import LeftOut, Mutant, Outcome, Verdict, Vocabulary
from mutabot.model.codec import from_data, printable, storable, to_data

from . import database, records
from .database import LAST, columns
from .files import WriterLock, previous_of, refuse_tracked
from .records import UNFIT, BaselineTest, ControlEnd, Kept, KeptBaseline, OriginalRun

T = TypeVar("T")
#: a key of meta that is the journal's own: why the campaign ended
_FINISHED_KEY = "journal:finished"
#: of a campaign that has not begun yet: why it ended, null as long as it has not
_ATTEMPT_KEY = "journal:attempt"
#: of a journal in which there is a baseline, and no campaign yet
_NONE_YET_KEY = "journal:none yet"
#: the tables of the baseline and the plan
_PLAN = ("test", "mutant", "left_out", "source")
#: from one campaign to the next
_ADOPT = f"""
INSERT OR REPLACE INTO known SELECT id, data, 1 FROM mutant;
INSERT OR REPLACE INTO kept SELECT mutant, round, verdict, data, key FROM outcome WHERE rowid IN ({LAST});
DELETE FROM meta;
DELETE FROM test;
DELETE FROM mutant;
DELETE FROM left_out;
DELETE FROM source;
DELETE FROM outcome;
DELETE FROM control
"""
#: from one journal to another: what is asked there, and what is done with each row here; the first counts
_TAKE = {
    f"SELECT * FROM outcome WHERE rowid IN ({LAST}) ORDER BY rowid":
        "INSERT INTO outcome SELECT ?1, ?2, ?3, ?4, ?5, ?6 "
        "WHERE NOT EXISTS (SELECT 1 FROM outcome WHERE mutant = ?1 AND round = ?2)",
    "SELECT * FROM parts": "INSERT OR IGNORE INTO parts VALUES (?, ?)",
    "SELECT * FROM text": "INSERT OR IGNORE INTO text VALUES (?, ?)",
    "SELECT * FROM kept": "INSERT OR IGNORE INTO kept VALUES (?, ?, ?, ?, ?)",
}  # fmt: skip
#: what SQLite says where it is the disk that cannot take what is written, and not the file that is wrong
_OF_THE_DISK = ("full",)


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


class JournalReader:
    """Read the record of a campaign; use as a context manager.

    Every method raises JournalError when the file cannot be read.

    Attributes:
        path: the file.
    """

    def __init__(self, path: Path, copy: sqlite3.Connection) -> None:
        self.path, self._copy = path, copy
        self._unfit: dict[str, None] = {}

    @property
    def set_aside(self) -> list[str]:
        """Descriptions of the invalid rows read so far; they are ignored."""
        return [*self._unfit]

    @staticmethod
    def open(path: Path, *, of_campaign: bool = True) -> JournalReader:
        """Open an existing journal, as it is now. It may be written meanwhile.

        ``of_campaign``: whether there must be more in it than a baseline.
        """
        if not path.is_file():
            raise database.no_journal(path)
        refuse_tracked(path)
        with guarded(path), ExitStack() as opened:
            with closing(database.connect_to_read(path)) as file:
                copy = opened.enter_context(closing(database.loaded(file)))
            database.check_schema(path, copy)
            copy.execute("PRAGMA query_only = ON")
            journal = JournalReader(path, copy)
            if of_campaign and journal._is_of_none:
                raise database.no_journal(path)
            opened.pop_all()
        return journal

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; the lock of a writer is given back."""
        self._copy.close()

    # What the campaign was and how it ended

    def meta(self) -> dict[str, Any]:
        """What the campaign said about itself."""
        found = {}
        for key, text in self._rows("SELECT key, value FROM meta"):
            if isinstance(key, str) and not key.startswith("journal:"):
                with self._checked("meta", key):
                    found[key] = records.fact(key, records.load(text))
        return {key: value for key, value in found.items() if value is not None}

    @property
    def vocabulary(self) -> Vocabulary | None:
        """The vocabulary of the campaign, if it was written down."""
        found: Vocabulary | None = self.meta().get("vocabulary")
        return found

    @property
    def finished(self) -> str | None:
        """Why the campaign ended; None while it runs and after it was killed."""
        return self._one("meta", _FINISHED_KEY, lambda text: str(records.load(text)))

    @property
    def attempt(self) -> str | None:
        """Why a later campaign ended before it had begun; empty if it was killed or is about to begin.

        None if there was no such campaign.
        """
        rows = self._rows("SELECT value FROM meta WHERE key = ?", _ATTEMPT_KEY)
        with self._checked("meta", _ATTEMPT_KEY):
            return str(records.load(rows[0][0]) or "") if rows else None
        return ""

    # The baseline and the plan

    def tests(self) -> list[BaselineTest]:
        """The tests of the baseline in the order they were added."""
        return self._all("test", BaselineTest)

    def controls(self) -> list[ControlEnd]:
        """The controls in the order they were added."""
        return self._all("control", ControlEnd)

    def mutants(self) -> list[Mutant]:
        """The planned mutants by number."""
        return sorted(self._all("mutant", Mutant), key=lambda one: one.number)

    def left_out(self) -> list[LeftOut]:
        """What the plan leaves out, in its order."""
        return self._all("left_out", LeftOut)

    def source(self, file: str) -> str | None:
        """The text of a mutated file at the time of the campaign, or None if it was not written down."""
        return self._one("source", file, records.text_in)

    def original(self) -> KeptBaseline | None:
        """The runs of the original that are kept; None if there are none."""
        head, runs = None, []
        for task, data, events in self._rows("SELECT task, data, events FROM original ORDER BY rowid"):
            with self._checked("original", task):
                row = {"task": task, "data": data}
                if task:
                    run = records.held(OriginalRun, row)
                    runs.append(replace(run, events=bytes(memoryview(events))))
                else:
                    head = records.held(KeptBaseline, {"data": data})
        return replace(head, runs=tuple(runs)) if head is not None else None

    # Outcomes

    def outcomes(self) -> list[Outcome]:
        """The last outcome of each (mutant, round), in the order they came."""
        return self._all("outcome", Outcome, f"WHERE rowid IN ({LAST}) ORDER BY rowid")

    def rounds_known(self) -> dict[str, int]:
        """In how many rounds each mutant has an outcome; those without any are missing."""
        return dict(self._rows("SELECT mutant, count(DISTINCT round) FROM outcome GROUP BY mutant"))

    def reused(self) -> set[tuple[str, int]]:
        """The mutants and rounds whose outcomes were taken over from an earlier campaign."""
        return set(self._rows(f"SELECT mutant, round FROM outcome WHERE reused AND rowid IN ({LAST})"))

    # Earlier campaigns

    def kept(self) -> dict[tuple[str, int], Kept]:
        """The last outcome of each mutant and round that earlier campaigns found, if it can be reused."""
        return self._kept_in("kept", "1")

    def found(self) -> dict[tuple[str, int], Kept]:
        """The same, with those that the last campaign itself found or knew."""
        return self.kept() | self._kept_in("outcome", f"rowid IN ({LAST})")

    def row(self, mutant: str, round: int) -> Kept | None:
        """One of those that were ``found``, with its data; None if it holds what no outcome can."""
        for table in ("outcome", "kept"):
            rows = self._rows(
                f"SELECT verdict, data, key FROM {table} WHERE mutant = ? AND round = ? AND key != '' "
                "ORDER BY rowid DESC LIMIT 1",
                mutant, round,
            )  # fmt: skip
            for verdict, data, key in rows:
                with self._checked(table, mutant, round):
                    row = {"mutant": mutant, "round": round, "verdict": verdict, "data": data}
                    return Kept(mutant, round, records.held(Outcome, row).verdict, key, data=data)
                return None
        raise KeyError((mutant, round))

    def _kept_in(self, table: str, which: str) -> dict[tuple[str, int], Kept]:
        rows = self._rows(
            "SELECT mutant, round, verdict, key, verdict NOT IN ('error', 'unstable') AND data NOT LIKE ? "
            f"FROM {table} WHERE key != '' AND {which}",
            f"%{os.strerror(errno.ENOSPC)}%",
        )
        found = {}
        for mutant, round, verdict, key, is_sound in rows:
            with self._checked(table, mutant, round):
                pair = records.text_in(mutant), records.round_in(round)
                found[pair] = Kept(*pair, Verdict(verdict), records.text_in(key), bool(is_sound))
        return found

    def kept_outcomes(self) -> list[Outcome]:
        """All that earlier campaigns found, also what cannot be reused."""
        return self._all("kept", Outcome)

    def known(self) -> list[tuple[Mutant, bool]]:
        """Mutants of earlier campaigns, and whether something has changed since that they depend on."""
        outdated = {name for (name,) in self._rows("SELECT id FROM known WHERE outdated != 0")}
        return [(one, one.id in outdated) for one in self._all("known", Mutant)]

    def parts(self, digest: str) -> dict[str, str] | None:
        """What a digest in a key stands for, or None if that is not known any more."""
        return self._one("parts", digest, lambda text: from_data(dict[str, str], records.load(text)))

    def text(self, digest: str) -> bytes | None:
        """What stood in a Python file with this digest, or None if that is not known any more."""
        return self._one("text", digest, lambda data: bytes(memoryview(data)))

    # Rows

    @property
    def _is_of_none(self) -> bool:
        """Whether no campaign has begun in it yet."""
        return bool(self._rows("SELECT 1 FROM meta WHERE key = ?", _NONE_YET_KEY))

    def _rows(self, statement: str, *values: Any) -> list[Any]:
        """What a question is answered with."""
        with guarded(self.path):
            return self._copy.execute(statement, _stored(values)).fetchall()

    def _all(self, table: str, kind: type[T], which: str = "ORDER BY rowid") -> list[T]:
        """The objects that the rows of a table hold."""
        found = []
        for row in self._rows(f"SELECT * FROM {table} {which}"):
            with self._checked(table, *row):
                found.append(records.held(kind, dict(zip(columns()[table], row, strict=True))))
        return found

    def _one(self, table: str, name: str, read: Callable[[Any], T]) -> T | None:
        """What a table of names and values has for a name; None if nothing, or what cannot be."""
        key, value = columns()[table]
        with self._checked(table, name):
            for (found,) in self._rows(f"SELECT {value} FROM {table} WHERE {key} = ?", name):
                return read(found)
        return None

    @contextmanager
    def _checked(self, table: str, *values: Any) -> Iterator[None]:
        """Leave a row that holds what cannot be, and go on with the next; the first values name it."""
        try:
            yield
        except UNFIT:
            self._unfit[f"{database.named_row(table, values)}"] = None


class Journal(JournalReader):
    """Write the record of a campaign; use as a context manager.

    Every method raises JournalError when the file cannot be read or written.

    Attributes:
        moved: where what lay in its place was moved to, if that was no journal of this version.
        lost: how often the file was deleted or replaced while it was written, in words; it was written again.
        altered: what somebody else changed in the file meanwhile, in words; it was written again.
    """

    def __init__(
        self, path: Path, copy: sqlite3.Connection, file: sqlite3.Connection, lock: WriterLock
    ) -> None:
        super().__init__(path, copy)
        self.moved: Path | None = None
        self.lost: list[str] = []
        self.altered: list[str] = []
        self._file, self._lock = file, lock
        self._done: list[tuple[str, tuple[Any, ...]]] | None = None  # in a transaction
        # whether there was nothing in the file: then the first transaction brings the tables into it
        self._is_new = not self._rows("SELECT count(*) FROM sqlite_master")[0][0]
        self._stamps = database.stamps(path)  # what it looks like when nobody else has written
        if self._is_new:
            copy.executescript(database.TABLES)
        # for its campaign to begin: until then it is that of the one before
        self._waits = not self._is_new and not self._is_of_none

    @classmethod
    def create(cls, path: Path, *, meta: Mapping[str, Any]) -> Journal:
        """``prepare`` and ``begin`` a campaign at once."""
        with ExitStack() as opened:
            journal = opened.enter_context(cls.prepare(path, meta=meta))
            journal.begin(meta)
            opened.pop_all()
        return journal

    @classmethod
    def prepare(cls, path: Path, *, meta: Mapping[str, Any]) -> Journal:
        """Take the journal for a campaign that is to ``begin``; until then it is that of the one before.

        If there is none before, it has begun. What is no journal of this version is moved aside.

        Reports understand these keys of ``meta``, all optional: ``mutabot``, ``python``, ``versions`` (name
        to version), ``root``, ``seed``, ``rounds``, ``engine``, ``jobs``, ``started``, ``vocabulary`` (what
        ``to_data`` makes of one).
        """
        refuse_tracked(path)
        with guarded(path), ExitStack() as opened:
            lock = WriterLock.take(path)
            opened.callback(lock.release)
            moved = database.set_aside(path)
            file = opened.enter_context(closing(database.connect(path)))
            copy = opened.enter_context(closing(database.loaded(file)))
            journal = opened.enter_context(cls(path, copy, file, lock))
            journal.moved = moved
            if journal._waits:
                # the campaign before has ended, whatever became of it; this one may fail to begin
                if journal.finished is None:
                    journal.set_meta(_FINISHED_KEY, "killed")
                journal.set_meta(_ATTEMPT_KEY, None)
            else:
                journal._begin(meta)
            opened.pop_all()
        return journal

    @classmethod
    def keep_original(cls, path: Path, kept: KeptBaseline) -> None:
        """Keep runs of the original for campaigns to come, and change nothing else that is there."""
        with cls.amend(path) as journal:
            if journal._is_new:
                journal.set_meta(_NONE_YET_KEY, True)
            journal.set_original(kept)

    @classmethod
    @contextmanager
    def amend(cls, path: Path) -> Iterator[Journal]:
        """Open a journal to change facts while no campaign runs; what it says of its campaign stays."""
        refuse_tracked(path)
        with guarded(path), ExitStack() as opened:
            lock = WriterLock.take(path)
            opened.callback(lock.release)
            file = opened.enter_context(closing(database.connect(path)))
            copy = opened.enter_context(closing(database.loaded(file)))
            journal = cls(path, copy, file, lock)
            opened.callback(journal.close)
            if not journal._is_new:
                database.check_schema(path, copy)
            yield journal

    def close(self) -> None:
        """Close the file, and give the lock back."""
        super().close()
        self._file.close()
        self._lock.release()

    def begin(self, meta: Mapping[str, Any]) -> None:
        """Begin the campaign. Mutants and outcomes of earlier campaigns are kept aside.

        All or nothing. A complete campaign stays readable as ``previous_of`` the path.
        """
        if not self._waits:
            return  # nothing was there before
        if self.finished == "complete":
            with guarded(self.path):
                database.write_anew(self._copy, previous_of(self.path))
        self._begin(meta)
        self._waits = False

    def _begin(self, meta: Mapping[str, Any]) -> None:
        with self._transaction():
            for statement in _ADOPT.split(";"):
                self._write(statement)
            for key, value in meta.items():
                self.set_meta(key, value)

    # What the campaign was and how it ended

    def set_meta(self, key: str, value: Any) -> None:
        """Add or replace a fact about the campaign."""
        self._put("meta", key, _dump(value))

    def finish(self, reason: str) -> None:
        """Note that the campaign has ended: ``complete``, ``interrupted`` or why it stopped.

        If it has not even begun, the journal stays that of the one before, and tells about the attempt.
        """
        with self._transaction(whole=True):
            pass  # what is not as it was written is written again
        if self.altered:
            self.set_meta(records.ALTERED, [*(self.meta().get(records.ALTERED) or []), *self.altered])
        self.set_meta(_ATTEMPT_KEY if self._waits else _FINISHED_KEY, reason)

    # The baseline and the plan

    def add_tests(self, tests: Iterable[BaselineTest]) -> None:
        """Add tests of the baseline, all or none."""
        with self._transaction():
            for one in tests:
                self._put("test", one.test.test, _dump(one))

    def add_control(self, control: ControlEnd) -> None:
        """Add the end of a control."""
        self._put("control", control.control, _dump(control))

    def set_original(self, kept: KeptBaseline) -> None:
        """Write down runs of the original in the place of those that are there, whole or not at all."""
        with self._transaction():
            self._write("DELETE FROM original")
            self._put("original", "", _dump(replace(kept, runs=())), b"")
            for run in kept.runs:
                facts = {"task": run.task, "exit_code": run.exit_code, "wall": run.wall}
                self._put("original", run.task, _dump(facts), run.events)

    def forget_original(self) -> None:
        """Keep no runs of the original."""
        self._write("DELETE FROM original")

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
        with self._transaction():
            for table in _PLAN[1:]:
                self._write(f"DELETE FROM {table}")
            for mutant in mutants:
                self._write("INSERT INTO mutant VALUES (?, ?)", mutant.id, _dump(mutant))
            for item in left_out:
                self._put("left_out", item.id, _dump(item))
            for file, text in (sources or {}).items():
                self._put("source", file, text)

    def keep_planned(self, mutants: Collection[str]) -> None:
        """Leave only these mutants in the plan."""
        with self._transaction():
            self._drop_others("mutant", "id", mutants)

    # Outcomes

    def add_outcome(self, outcome: Outcome, *, key: str = "") -> None:
        """Add an outcome, replacing an earlier one of the same mutant and round.

        ``key`` is what it depends on; the empty key says that nobody knows, and that it is not to be reused.
        """
        verdict, data = outcome.verdict.value, _dump(outcome)
        self._put("outcome", outcome.mutant, outcome.round, verdict, data, key, 0)

    def add_parts(self, parts: Mapping[str, Mapping[str, str]]) -> None:
        """Write down what digests in keys stand for."""
        for digest, data in parts.items():
            self._write("INSERT OR IGNORE INTO parts VALUES (?, ?)", digest, _dump(data))

    def add_texts(self, texts: Mapping[str, bytes]) -> None:
        """Write down what stands in Python files, by the digest."""
        with self._transaction():
            for digest, text in texts.items():
                self._write("INSERT OR IGNORE INTO text VALUES (?, ?)", digest, text)

    def forget_keys(self) -> None:
        """Never reuse what this campaign has found itself."""
        self._write("UPDATE outcome SET key = '' WHERE NOT reused")

    # Earlier campaigns

    def take_over(self, found: Iterable[Kept]) -> None:
        """Add outcomes of earlier campaigns."""
        with self._transaction():
            for one in found:
                self._put("outcome", one.mutant, one.round, one.verdict.value, one.data, one.key, 1)

    def forget(self, mutants: Iterable[str]) -> None:
        """Never reuse what earlier campaigns found about these mutants."""
        with self._transaction():
            for mutant in mutants:
                self._write("UPDATE kept SET key = '' WHERE mutant = ?", mutant)

    def set_known(self, known: Iterable[tuple[Mutant, bool]]) -> None:
        """Write down the mutants of earlier campaigns that the program still has."""
        with self._transaction():
            self._write("DELETE FROM known")
            for mutant, outdated in known:
                self._put("known", mutant.id, _dump(mutant), int(outdated))

    def tidy(self, mutants: Collection[str]) -> None:
        """Forget what earlier campaigns found about other mutants, and what nothing refers to."""
        with self._transaction():
            self._drop_others("kept", "mutant", mutants)
            keys = self._rows("SELECT key FROM kept UNION SELECT key FROM outcome")
            self._drop_others("parts", "digest", {digest for (key,) in keys for digest in key.split()})
            trees = {key.split()[3] for (key,) in keys if len(key.split()) > 3}
            parts = [self.parts(tree) or {} for tree in trees]
            self._drop_others("text", "digest", {digest for one in parts for digest in one.values()})

    def _drop_others(self, table: str, column: str, kept: Collection[str]) -> None:
        for (value,) in self._rows(f"SELECT DISTINCT {column} FROM {table}"):
            if value not in kept:
                self._write(f"DELETE FROM {table} WHERE {column} = ?", value)

    # Shards

    def take_plan(self, other: JournalReader) -> None:
        """Take over the plan of another journal, its baseline and the texts, whole or not at all."""
        with self._transaction():
            for table in _PLAN:
                self._write(f"DELETE FROM {table}")
                for row in other._rows(f"SELECT * FROM {table} ORDER BY rowid"):
                    self._put(table, *row)

    def take_outcomes(self, other: JournalReader) -> None:
        """Take over what another journal has found and knows of earlier campaigns; what is there stays."""
        known = {(one.test_file, one.control, one.ok) for one in self.controls()}
        with self._transaction():
            for question, statement in _TAKE.items():
                for row in other._rows(question):
                    self._write(statement, *row)
            for one in other.controls():
                if (one.test_file, one.control, one.ok) not in known:
                    self.add_control(one)

    # Writing

    def _put(self, table: str, *values: Any) -> None:
        """Add a row, replacing one of the same name where names are unique."""
        self._write(f"INSERT OR REPLACE INTO {table} VALUES ({', '.join('?' * len(values))})", *values)

    def _write(self, statement: str, *values: Any) -> None:
        """Execute a statement; within ``_transaction``, as a part of it."""
        if self._done is None:
            with self._transaction():
                self._write(statement, *values)
            return
        given = _stored(values)
        with guarded(self.path):
            self._copy.execute(statement, given)
        self._done.append((statement, given))

    @contextmanager
    def _transaction(self, *, whole: bool = False) -> Iterator[None]:
        """What is written meanwhile takes effect together or not at all, in both databases.

        Before, the file is compared with what was written if somebody else wrote, and row by row if it is to
        be ``whole``; after, it is written again if it is not so.
        """
        with guarded(self.path):
            is_ours = False
            with self._noted():
                self._file.execute("BEGIN IMMEDIATE")  # from here on nobody else can write
                is_ours = not self._is_new and self._is_ours(whole)
            self._copy.execute("BEGIN")
            try:
                self._done = []
                yield
                if is_ours:
                    is_ours = self._repeat_in_file(self._done)
                self._copy.execute("COMMIT")
            except BaseException:
                self._copy.rollback()
                raise
            finally:
                self._done = None
                with suppress(sqlite3.Error):
                    self._file.rollback()
            if not is_ours:
                self._restore()

    def _repeat_in_file(self, done: list[tuple[str, tuple[Any, ...]]]) -> bool:
        """Write into the file what was written; returns whether it is there."""
        with self._noted():
            for statement, values in done:
                self._file.execute(statement, values)
            self._file.execute("COMMIT")
            self._stamps = database.stamps(self.path)
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
            self.altered.append(f"the file cannot be written any more ({error})")

    def _is_ours(self, whole: bool) -> bool:
        """Whether the file holds what was written; says what does not. ``whole``: every row is looked at."""
        self._lock.renew()
        now = database.stamps(self.path)
        is_there, has_log = (
            one is not None and before is not None and one[:2] == before[:2]
            for one, before in zip(now, self._stamps, strict=True)
        )  # fmt: skip
        if not is_there:
            self.lost.append("was deleted or replaced")
            return False
        found: list[str] = []
        if whole or now != self._stamps:
            try:
                with closing(database.connect_to_read(self.path)) as file:
                    found = database.differences(file, self._copy)
            except (sqlite3.Error, OSError) as error:
                found = [f"the file cannot be read any more ({error})"]
        self.altered += found
        return has_log and not found

    def _restore(self) -> None:
        """Write the file anew, and put it in the place of whatever is there."""
        with suppress(sqlite3.Error):
            self._file.close()
        self._lock.renew()
        database.write_anew(self._copy, self.path)
        self._file, self._is_new = database.connect(self.path), False
        self._stamps = database.stamps(self.path)


def kept_original(path: Path) -> KeptBaseline | None:
    """The runs of the original that a journal keeps; None if there is none, or it cannot be used."""
    with suppress(JournalError), JournalReader.open(path, of_campaign=False) as journal:
        return journal.original()
    return None


def _stored(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """Values of a row, with texts that can be stored."""
    return tuple(printable(value) if isinstance(value, str) else value for value in values)


def _dump(value: Any) -> str:
    """A value as JSON that can be stored."""
    try:
        text = json.dumps(to_data(value), ensure_ascii=False, default=str)
        text.encode()
    except (ValueError, RecursionError):  # what no other process said: the names of files, for instance
        return json.dumps(storable(value, str), ensure_ascii=False)
    return text
