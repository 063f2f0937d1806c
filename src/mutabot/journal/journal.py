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

import json
import sqlite3
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mutabot.model.codec import storable, to_data

from . import database, records
from .database import LAST
from .files import WriterLock, previous_of, refuse_tracked
from .reader import ATTEMPT_KEY, FINISHED_KEY, NONE_YET_KEY, JournalReader

if TYPE_CHECKING:
    from mutabot.model import LeftOut, Mutant, Outcome

    from .records import BaselineTest, ControlEnd, Kept, KeptBaseline

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


class Journal(JournalReader):
    """A writer for the record of a campaign; use as a context manager.

    Every method raises JournalError when the file cannot be read or written.

    Attributes:
        moved: where what lay in its place was moved to, if that was no journal of this version.
        lost: descriptions of how the file was deleted or replaced while it was written; it was written again.
        altered: descriptions of what another process changed in the file meanwhile; it was written again.
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
        self._stamps = database.stamps(path)  # what it looks like when no other process has written
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
        """Open the journal for a campaign that is to ``begin``; until then it keeps the previous one.

        If there is none before, it has begun. What is no journal of this version is moved aside.

        Reports understand these keys of ``meta``, all optional: ``mutabot``, ``python``, ``versions`` (name
        to version), ``root``, ``seed``, ``rounds``, ``engine``, ``jobs``, ``started``, ``vocabulary`` (what
        ``to_data`` makes of one).
        """
        refuse_tracked(path)
        with database.guarded(path), ExitStack() as opened:
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
                    journal.set_meta(FINISHED_KEY, "killed")
                journal.set_meta(ATTEMPT_KEY, None)
            else:
                journal._begin(meta)
            opened.pop_all()
        return journal

    @classmethod
    def keep_original(cls, path: Path, kept: KeptBaseline) -> None:
        """Keep runs of the original for later campaigns; leave the rest of the journal unchanged."""
        with cls.amend(path) as journal:
            if journal._is_new:
                journal.set_meta(NONE_YET_KEY, True)
            journal.set_original(kept)

    @classmethod
    @contextmanager
    def amend(cls, path: Path) -> Iterator[Journal]:
        """Open a journal to change facts while no campaign runs; its campaign stays as it is."""
        refuse_tracked(path)
        with database.guarded(path), ExitStack() as opened:
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
        """Close the file, and release the lock."""
        super().close()
        self._file.close()
        self._lock.release()

    def begin(self, meta: Mapping[str, Any]) -> None:
        """Begin the campaign, and keep mutants and outcomes of earlier ones for reuse.

        All or nothing. A complete campaign stays readable as ``previous_of`` the path.
        """
        if not self._waits:
            return  # nothing was there before
        if self.finished == "complete":
            with database.guarded(self.path):
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

        If it has not even begun, the journal stays that of the one before, and mentions the attempt.
        """
        with self._transaction(whole=True):
            pass  # what is not as it was written is written again
        if self.altered:
            self.set_meta(records.ALTERED, [*(self.meta().get(records.ALTERED) or []), *self.altered])
        self.set_meta(ATTEMPT_KEY if self._waits else FINISHED_KEY, reason)

    # The baseline and the plan

    def add_tests(self, tests: Iterable[BaselineTest]) -> None:
        """Add tests of the baseline, all or none."""
        with self._transaction():
            for row in tests:
                self._put("test", row.test.test, _dump(row))

    def add_control(self, control: ControlEnd) -> None:
        """Add the end of a control."""
        self._put("control", control.control, _dump(control))

    def set_original(self, kept: KeptBaseline) -> None:
        """Replace the stored runs of the original, in one transaction."""
        with self._transaction():
            self._write("DELETE FROM original")
            self._put("original", "", _dump(replace(kept, runs=())), b"")
            for run in kept.runs:
                facts = {"task": run.task, "exit_code": run.exit_code, "wall": run.wall}
                self._put("original", run.task, _dump(facts), run.events)

    def forget_original(self) -> None:
        """Remove the stored runs of the original."""
        self._write("DELETE FROM original")

    def set_plan(
        self,
        mutants: Iterable[Mutant],
        left_out: Iterable[LeftOut],
        *,
        sources: Mapping[str, str] | None = None,
    ) -> None:
        """Record the plan in one transaction; an older plan is replaced.

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

        ``key`` is what it depends on; the empty key says that this is unknown, so that it is not reused.
        """
        verdict, data = outcome.verdict.value, _dump(outcome)
        self._put("outcome", outcome.mutant, outcome.round, verdict, data, key, 0)

    def add_parts(self, parts: Mapping[str, Mapping[str, str]]) -> None:
        """Store the contents behind the digests in keys."""
        for digest, data in parts.items():
            self._write("INSERT OR IGNORE INTO parts VALUES (?, ?)", digest, _dump(data))

    def add_texts(self, texts: Mapping[str, bytes]) -> None:
        """Store the text of Python files by its digest."""
        with self._transaction():
            for digest, text in texts.items():
                self._write("INSERT OR IGNORE INTO text VALUES (?, ?)", digest, text)

    def forget_keys(self) -> None:
        """Never reuse the outcomes of this campaign itself."""
        self._write("UPDATE outcome SET key = '' WHERE NOT reused")

    # Earlier campaigns

    def take_over(self, found: Iterable[Kept]) -> None:
        """Add outcomes of earlier campaigns."""
        with self._transaction():
            for kept in found:
                verdict = kept.verdict.value
                self._put("outcome", kept.mutant, kept.round, verdict, kept.data, kept.key, 1)

    def forget(self, mutants: Iterable[str]) -> None:
        """Never reuse what earlier campaigns found about these mutants."""
        with self._transaction():
            for mutant in mutants:
                self._write("UPDATE kept SET key = '' WHERE mutant = ?", mutant)

    def set_known(self, known: Iterable[tuple[Mutant, bool]]) -> None:
        """Record the mutants of earlier campaigns that the program still has."""
        with self._transaction():
            self._write("DELETE FROM known")
            for mutant, outdated in known:
                self._put("known", mutant.id, _dump(mutant), int(outdated))

    def tidy(self, mutants: Collection[str]) -> None:
        """Forget what earlier campaigns found about other mutants, and unreferenced contents."""
        with self._transaction():
            self._drop_others("kept", "mutant", mutants)
            keys = self._rows("SELECT key FROM kept UNION SELECT key FROM outcome")
            self._drop_others("parts", "digest", {digest for (key,) in keys for digest in key.split()})
            trees = {key.split()[3] for (key,) in keys if len(key.split()) > 3}
            parts = [self.parts(tree) or {} for tree in trees]
            self._drop_others("text", "digest", {digest for part in parts for digest in part.values()})

    def _drop_others(self, table: str, column: str, kept: Collection[str]) -> None:
        for (value,) in self._rows(f"SELECT DISTINCT {column} FROM {table}"):
            if value not in kept:
                self._write(f"DELETE FROM {table} WHERE {column} = ?", value)

    # Shards

    def take_plan(self, other: JournalReader) -> None:
        """Copy the plan, the baseline and the texts of another journal, in one transaction."""
        with self._transaction():
            for table in _PLAN:
                self._write(f"DELETE FROM {table}")
                for row in other._rows(f"SELECT * FROM {table} ORDER BY rowid"):
                    self._put(table, *row)

    def take_outcomes(self, other: JournalReader) -> None:
        """Copy the outcomes and earlier outcomes of another journal; existing ones stay."""
        known = {(end.test_file, end.control, end.ok) for end in self.controls()}
        with self._transaction():
            for question, statement in _TAKE.items():
                for row in other._rows(question):
                    self._write(statement, *row)
            for control in other.controls():
                if (control.test_file, control.control, control.ok) not in known:
                    self.add_control(control)

    # Writing

    def _put(self, table: str, *values: Any) -> None:
        """Insert a row, or replace the one with the same key."""
        self._write(f"INSERT OR REPLACE INTO {table} VALUES ({', '.join('?' * len(values))})", *values)

    def _write(self, statement: str, *values: Any) -> None:
        """Execute a statement; within ``_transaction``, as a part of it."""
        if self._done is None:
            with self._transaction():
                self._write(statement, *values)
            return
        given = database.stored(values)
        with database.guarded(self.path):
            self._copy.execute(statement, given)
        self._done.append((statement, given))

    @contextmanager
    def _transaction(self, *, whole: bool = False) -> Iterator[None]:
        """Apply what is written inside the context together or not at all, in both databases.

        Before, the file is compared with what was written if another process wrote, and row by row if it is
        to be ``whole``; after, it is written again if it is not so.
        """
        with database.guarded(self.path):
            is_ours = False
            with self._noted():
                self._file.execute("BEGIN IMMEDIATE")  # from here on no other process can write
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
        """Write the same into the file. Return whether that succeeded."""
        with self._noted():
            for statement, values in done:
                self._file.execute(statement, values)
            self._file.execute("COMMIT")
            self._stamps = database.stamps(self.path)
            return True
        return False

    @contextmanager
    def _noted(self) -> Iterator[None]:
        """Continue without the file if it is invalid, and note that."""
        try:
            yield
        except sqlite3.Error as error:
            if any(text in str(error) for text in _OF_THE_DISK):
                raise
            self.altered.append(f"the file cannot be written any more ({error})")

    def _is_ours(self, whole: bool) -> bool:
        """Return whether the file holds what was written, and note deviations. ``whole``: check every row."""
        self._lock.renew()
        now = database.stamps(self.path)
        is_there, has_log = (
            stamp is not None and before is not None and stamp[:2] == before[:2]
            for stamp, before in zip(now, self._stamps, strict=True)
        )  # fmt: skip
        if not is_there:
            self.lost.append("was deleted or replaced")
            return False
        found: list[str] = []
        if whole or now != self._stamps:
            try:
                with closing(database.connect_to_read(self.path)) as file:
                    found = database.row_differences(file, self._copy)
            except (sqlite3.Error, OSError) as error:
                found = [f"the file cannot be read any more ({error})"]
        self.altered += found
        return has_log and not found

    def _restore(self) -> None:
        """Rewrite the file, replacing whatever is there."""
        with suppress(sqlite3.Error):
            self._file.close()
        self._lock.renew()
        database.write_anew(self._copy, self.path)
        self._file, self._is_new = database.connect(self.path), False
        self._stamps = database.stamps(self.path)


def _dump(value: Any) -> str:
    """Return a value as JSON that can be stored."""
    try:
        text = json.dumps(to_data(value), ensure_ascii=False, default=str)
        text.encode()
    except (ValueError, RecursionError):  # what no other process said: the names of files, for instance
        return json.dumps(storable(value, str), ensure_ascii=False)
    return text
