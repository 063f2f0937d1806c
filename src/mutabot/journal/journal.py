"""The journal: one SQLite file with the plan, the baseline and every outcome of a campaign.

One process writes, any number read, also while it writes and after it was killed. What is added is
committed at once: a campaign that is killed loses nothing that it had found. All else (reports, resuming,
comparing) reads from here.

A new campaign begins in the same file: in one transaction the plan, the baseline and the outcomes of the
one before make way. Its mutants and outcomes are kept aside: outcomes that still hold are taken over, and
reports show those that a campaign of other mutants leaves alone.
"""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Self, TypeVar

from mutabot.model import LeftOut, Mutant, Outcome, Verdict, Vocabulary
from mutabot.model.codec import from_data, storable, to_data
from mutabot.model.events import TestEnd

from . import records
from .database import LAST, Database, guarded, make_way, named_row, write_anew
from .files import WriterLock, previous_of, refuse_tracked
from .records import UNFIT, BaselineTest, ControlEnd, Kept, MovedOutcome

T = TypeVar("T")
#: a key of meta that is the journal's own: why the campaign ended
_FINISHED_KEY = "journal:finished"
#: of a campaign that has not begun yet: why it ended, null as long as it has not
_ATTEMPT_KEY = "journal:attempt"
#: the tables of the baseline and the plan
_PLAN = ("test", "mutant", "left_out", "source")
#: from one campaign to the next
_ADOPT = f"""
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
_TAKE = {
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


class JournalReader:
    """The record of one campaign, to be read; use as a context manager.

    Every method raises JournalError when the file cannot be read.

    Attributes:
        path: the file.
    """

    def __init__(self, store: Database) -> None:
        self.path, self._store = store.path, store
        self._unfit: dict[str, None] = {}

    @property
    def set_aside(self) -> list[str]:
        """Rows that hold what cannot be, in words, as far as they were read: nobody believes them."""
        return [*self._unfit]

    @staticmethod
    def open(path: Path) -> JournalReader:
        """Open an existing journal. It may be written meanwhile."""
        return JournalReader(Database.to_read(path))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; the lock of a writer is given back."""
        self._store.close()

    # What the campaign was and how it ended

    def meta(self) -> dict[str, Any]:
        """What the campaign said about itself."""
        found = {}
        for key, text in self._store.rows("SELECT key, value FROM meta"):
            if isinstance(key, str) and not key.startswith("journal:"):
                with self._checked("meta", key):
                    found[key] = records.fact(key, records.load(text))
        return {key: value for key, value in found.items() if value is not None}

    @property
    def vocabulary(self) -> Vocabulary | None:
        """The vocabulary of the campaign, if it was written down."""
        data = self.meta().get("vocabulary")
        return from_data(Vocabulary, data) if data is not None else None

    @property
    def finished(self) -> str | None:
        """Why the campaign ended; None while it runs and after it was killed."""
        return self._one("meta", "value", "key", _FINISHED_KEY, lambda text: str(records.load(text)))

    @property
    def attempt(self) -> str | None:
        """Why a later campaign ended before it had begun; empty if it was killed or is about to begin.

        None if there was no such campaign.
        """
        rows = self._store.rows("SELECT value FROM meta WHERE key = ?", _ATTEMPT_KEY)
        with self._checked("meta", _ATTEMPT_KEY):
            return str(records.load(rows[0][0]) or "") if rows else None
        return ""

    # The baseline and the plan

    def tests(self) -> list[BaselineTest]:
        """The tests of the baseline in the order they were added."""
        return self._all("test", records.baseline_test_in)

    def controls(self) -> list[ControlEnd]:
        """The controls in the order they were added."""
        return self._all("control", records.control_in)

    def mutants(self) -> list[Mutant]:
        """The planned mutants by number."""
        return self._all("mutant", records.planned_in, "ORDER BY number, rowid")

    def left_out(self) -> list[LeftOut]:
        """What the plan leaves out, in its order."""
        return self._all("left_out", records.left_out_in)

    def source(self, file: str) -> str | None:
        """The text of a mutated file at the time of the campaign, or None if it was not written down."""
        return self._one("source", "text", "file", file, records.text_in)

    # Outcomes

    def outcomes(self) -> list[Outcome]:
        """The last outcome of each (mutant, round), in the order they came."""
        return self._all("outcome", records.outcome_in, f"WHERE rowid IN ({LAST}) ORDER BY rowid")

    def rounds_known(self) -> dict[str, int]:
        """In how many rounds each mutant has an outcome; those without any are missing."""
        return dict(self._store.rows("SELECT mutant, count(DISTINCT round) FROM outcome GROUP BY mutant"))

    def reused(self) -> set[tuple[str, int]]:
        """The mutants and rounds whose outcomes were taken over from an earlier campaign."""
        return set(self._store.rows(f"SELECT mutant, round FROM outcome WHERE reused AND rowid IN ({LAST})"))

    # Earlier campaigns

    def kept(self) -> dict[tuple[str, int], Kept]:
        """The last outcome of each mutant and round that earlier campaigns found, if it can be reused."""
        return self._of_rows("kept", "SELECT mutant, round, verdict, data, key FROM kept")

    def found(self) -> dict[tuple[str, int], Kept]:
        """The same, with those that the last campaign itself found or knew."""
        return self.kept() | self._of_rows(
            "outcome",
            f"SELECT mutant, round, verdict, data, key FROM outcome WHERE rowid IN ({LAST})",
        )

    def row(self, mutant: str, round: int) -> MovedOutcome | None:
        """One of those that were ``found``; None if it holds what no outcome can."""
        for table, condition in (("outcome", "ORDER BY rowid DESC"), ("kept", "")):
            rows = self._store.rows(
                f'SELECT verdict, "by", data, key FROM {table} '
                f"WHERE mutant = ? AND round = ? AND key != '' {condition} LIMIT 1",
                mutant, round,
            )  # fmt: skip
            for verdict, by, text, key in rows:
                with self._checked(table, mutant, round):
                    records.outcome_in(mutant, round, verdict, by, text)
                    return MovedOutcome(mutant, round, verdict, by, text, key)
                return None
        raise KeyError((mutant, round))

    def _of_rows(self, table: str, question: str) -> dict[tuple[str, int], Kept]:
        rows = self._store.rows(
            "SELECT mutant, round, key, verdict NOT IN ('error', 'unstable') AND data NOT LIKE ?, verdict "
            f"FROM ({question}) WHERE key != ''",
            f"%{os.strerror(errno.ENOSPC)}%",
        )
        found = {}
        for mutant, round, key, sound, verdict in rows:
            with self._checked(table, mutant, round):
                found[records.text_in(mutant), records.round_in(round)] = Kept(
                    records.text_in(key), bool(sound), Verdict(verdict)
                )
        return found

    def kept_outcomes(self) -> list[Outcome]:
        """All that earlier campaigns found, also what cannot be reused."""
        return self._all("kept", records.outcome_in)

    def known(self) -> list[tuple[Mutant, bool]]:
        """Mutants of earlier campaigns, and whether something has changed since that they depend on."""
        return self._all("known", records.known_in)

    def parts(self, digest: str) -> dict[str, str] | None:
        """What a digest in a key stands for, or None if that is not known any more."""
        return self._one("parts", "data", "digest", digest, records.parts_in)

    def text(self, digest: str) -> bytes | None:
        """What stood in a Python file with this digest, or None if that is not known any more."""
        return self._one("text", "data", "digest", digest, records.bytes_in)

    def _all(self, table: str, read: Callable[..., T], which: str = "ORDER BY rowid") -> list[T]:
        """What the rows of a table hold, from all their columns."""
        found = []
        for row in self._store.rows(f"SELECT * FROM {table} {which}"):
            with self._checked(table, *row):
                found.append(read(*row))
        return found

    def _one(self, table: str, column: str, key: str, name: str, read: Callable[[Any], T]) -> T | None:
        """What a row holds that is known by a name; None if there is none, or it holds what cannot be."""
        with self._checked(table, name):
            for (found,) in self._store.rows(f"SELECT {column} FROM {table} WHERE {key} = ?", name):
                return read(found)
        return None

    @contextmanager
    def _checked(self, table: str, *values: Any) -> Iterator[None]:
        """Leave a row that holds what cannot be, and go on with the next; the first values name it."""
        try:
            yield
        except UNFIT:
            self._unfit[f"{named_row(table, values)}"] = None


class Journal(JournalReader):
    """The record of one campaign, to be written; use as a context manager.

    Every method raises JournalError when the file cannot be read or written.

    Attributes:
        moved: where what lay in its place was moved to, if that was no journal of this version.
        lost: how often the file was deleted or replaced while it was written, in words; it was written again.
        altered: what somebody else changed in the file meanwhile, in words; it was written again.
    """

    def __init__(self, store: Database, moved: Path | None, *, waits: bool) -> None:
        super().__init__(store)
        self.moved = moved
        self.lost, self.altered = store.lost, store.altered
        self._waits = waits  # for its campaign to begin: until then it is that of the one before

    @classmethod
    def create(cls, path: Path, *, meta: Mapping[str, Any]) -> Journal:
        """``prepare`` and ``begin`` a campaign at once."""
        journal = cls.prepare(path, meta=meta)
        with journal._store.closed_on_error():
            journal.begin(meta)
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
        with guarded(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            lock = WriterLock.take(path)
            try:
                moved = make_way(path)
                store = Database.to_write(path, lock)
            except BaseException:
                lock.release()
                raise
        journal = cls(store, moved, waits=not store.is_new)
        with store.closed_on_error():
            if journal._waits:
                # the campaign before has ended, whatever became of it; this one may fail to begin
                if journal.finished is None:
                    journal.set_meta(_FINISHED_KEY, "killed")
                journal.set_meta(_ATTEMPT_KEY, None)
            else:
                journal._begin(meta)
        return journal

    def begin(self, meta: Mapping[str, Any]) -> None:
        """Begin the campaign. Mutants and outcomes of those before are kept aside.

        All or nothing. A complete campaign stays readable as ``previous_of`` the path.
        """
        if not self._waits:
            return  # nothing was there before
        if self.finished == "complete":
            with guarded(self.path):
                write_anew(self._store.copy, previous_of(self.path))
        self._begin(meta)
        self._waits = False

    def _begin(self, meta: Mapping[str, Any]) -> None:
        with self._store.transaction():
            if self._waits:
                for statement in _ADOPT.split(";"):
                    self._store.write(statement)
            for key, value in meta.items():
                self.set_meta(key, value)

    # What the campaign was and how it ended

    def set_meta(self, key: str, value: Any) -> None:
        """Add or replace one fact about the campaign."""
        self._store.write("INSERT OR REPLACE INTO meta VALUES (?, ?)", key, _dump(value))

    def finish(self, reason: str) -> None:
        """Note that the campaign has ended: ``complete``, ``interrupted`` or why it stopped.

        If it has not even begun, the journal stays that of the one before, and tells about the attempt.
        """
        with self._store.transaction(whole=True):
            pass  # what is not as it was written is written again
        if self.altered:
            self.set_meta(records.ALTERED, [*(self.meta().get(records.ALTERED) or []), *self.altered])
        self.set_meta(_ATTEMPT_KEY if self._waits else _FINISHED_KEY, reason)

    # The baseline and the plan

    def add_test(self, round: int, repetition: int, test: TestEnd) -> None:
        """Add one test of the baseline; the same test again replaces it."""
        self._store.write(
            "INSERT OR REPLACE INTO test VALUES (?, ?, ?, ?, ?)",
            round, repetition, test.test, test.outcome, _dump(test),
        )  # fmt: skip

    def add_control(self, test_file: str, control: str, ok: bool, detail: str = "") -> None:
        """Add the end of one control mutant."""
        self._store.write("INSERT INTO control VALUES (?, ?, ?, ?)", test_file, control, int(ok), detail)

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
        with self._store.transaction():
            for table in _PLAN[1:]:
                self._store.write(f"DELETE FROM {table}")
            for mutant in mutants:
                row = mutant.number, mutant.id, _dump(mutant)
                self._store.write("INSERT INTO mutant VALUES (?, ?, ?)", *row)
            for item in left_out:
                self._store.write("INSERT INTO left_out VALUES (?, ?, ?)", item.id, item.reason, _dump(item))
            for file, text in (sources or {}).items():
                self._store.write("INSERT INTO source VALUES (?, ?)", file, text)

    def keep_planned(self, mutants: Collection[str]) -> None:
        """Leave only these mutants in the plan."""
        with self._store.transaction():
            self._drop_others("mutant", "id", mutants)

    # Outcomes

    def add_outcome(self, outcome: Outcome, *, key: str = "") -> None:
        """Add one outcome; a later one of the same mutant and round takes its place.

        ``key`` is what it depends on; the empty key says that nobody knows, and that it is not to be reused.
        """
        self._store.write(
            "INSERT INTO outcome VALUES (?, ?, ?, ?, ?, ?, 0)",
            outcome.mutant, outcome.round, outcome.verdict.value, outcome.by.value if outcome.by else None,
            _dump(outcome), key,
        )  # fmt: skip

    def add_parts(self, parts: Mapping[str, Mapping[str, str]]) -> None:
        """Write down what digests in keys stand for."""
        for digest, data in parts.items():
            self._store.write("INSERT OR IGNORE INTO parts VALUES (?, ?)", digest, _dump(data))

    def add_texts(self, texts: Mapping[str, bytes]) -> None:
        """Write down what stands in Python files, by the digest."""
        with self._store.transaction():
            for digest, text in texts.items():
                self._store.write("INSERT OR IGNORE INTO text VALUES (?, ?)", digest, text)

    def forget_keys(self) -> None:
        """Never reuse what this campaign has found itself."""
        self._store.write("UPDATE outcome SET key = '' WHERE NOT reused")

    # Earlier campaigns

    def take_over(self, rows: Iterable[MovedOutcome]) -> None:
        """Add outcomes of earlier campaigns."""
        with self._store.transaction():
            for row in rows:
                self._store.write(
                    "INSERT INTO outcome VALUES (?, ?, ?, ?, ?, ?, 1)",
                    row.mutant, row.round, row.verdict, row.by, row.data, row.key,
                )  # fmt: skip

    def forget(self, mutants: Iterable[str]) -> None:
        """Never reuse what earlier campaigns found about these mutants."""
        with self._store.transaction():
            for mutant in mutants:
                self._store.write("UPDATE kept SET key = '' WHERE mutant = ?", mutant)

    def set_known(self, known: Iterable[tuple[Mutant, bool]]) -> None:
        """Write down the mutants of earlier campaigns that the program still has."""
        with self._store.transaction():
            self._store.write("DELETE FROM known")
            for mutant, outdated in known:
                self._store.write(
                    "INSERT INTO known VALUES (?, ?, ?)", mutant.id, _dump(mutant), int(outdated)
                )

    def tidy(self, mutants: Collection[str]) -> None:
        """Forget what earlier campaigns found about other mutants, and what nothing refers to."""
        with self._store.transaction():
            self._drop_others("kept", "mutant", mutants)
            keys = self._store.rows("SELECT key FROM kept UNION SELECT key FROM outcome")
            self._drop_others("parts", "digest", {digest for (key,) in keys for digest in key.split()})
            trees = {key.split()[3] for (key,) in keys if len(key.split()) > 3}
            parts = [self.parts(tree) or {} for tree in trees]
            self._drop_others("text", "digest", {digest for one in parts for digest in one.values()})

    def _drop_others(self, table: str, column: str, kept: Collection[str]) -> None:
        for (value,) in self._store.rows(f"SELECT DISTINCT {column} FROM {table}"):
            if value not in kept:
                self._store.write(f"DELETE FROM {table} WHERE {column} = ?", value)

    # Shards

    def take_plan(self, other: JournalReader) -> None:
        """Take over the plan of another journal, its baseline and the texts, whole or not at all."""
        with self._store.transaction():
            for table in _PLAN:
                self._store.write(f"DELETE FROM {table}")
                for row in other._store.rows(f"SELECT * FROM {table} ORDER BY rowid"):
                    self._store.write(f"INSERT INTO {table} VALUES ({', '.join('?' * len(row))})", *row)

    def take_outcomes(self, other: JournalReader) -> None:
        """Take over what another journal has found and knows of earlier campaigns; what is there stays."""
        with self._store.transaction():
            for question, statement in _TAKE.items():
                for row in other._store.rows(question):
                    self._store.write(statement, *row)


def _dump(value: Any) -> str:
    """A value as JSON that can be stored."""
    try:
        text = json.dumps(to_data(value), ensure_ascii=False, default=str)
        text.encode()
    except (ValueError, RecursionError):  # what no other process said: the names of files, for instance
        return json.dumps(storable(value, str), ensure_ascii=False)
    return text
