"""The journal: one SQLite file with the plan, the baseline and every outcome of a campaign.

One process writes, any number read, also while it writes and after it was killed. What is added is
committed at once: a campaign that is killed loses nothing that it had found. All else (reports, resuming,
comparing) reads from here.

A new campaign begins in the same file: in one transaction the plan, the baseline and the outcomes of the
one before make way. Its mutants and outcomes are kept aside: outcomes that still hold are taken over, and
reports show those that a campaign of other mutants leaves alone.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

from mutabot.journal.lock import WriterLock, refuse_tracked
from mutabot.model import LeftOut, Mutant, Outcome
from mutabot.model.events import TestEnd

from .database import (
    ADOPT,
    ATTEMPT_KEY,
    FINISHED_KEY,
    KNOWN_BEFORE,
    SCHEMA_VERSION,
    TAKE,
    VERSION_KEY,
    guarded,
)
from .reader import JournalReader
from .records import ALTERED, Row
from .store import Store, dump, keep_copy, make_way


class Journal(JournalReader):
    """The record of one campaign, to be written; use as a context manager.

    Every method raises JournalError when the file cannot be read or written.

    Attributes:
        moved: where what lay in its place was moved to, if that was no journal of this version.
        lost: how often the file was deleted or replaced while it was written, in words; it was written again.
        altered: what somebody else changed in the file meanwhile, in words; it was written again.
        unstored: why rows of this campaign could not be stored, one line each: all others are.
    """

    def __init__(self, store: Store, moved: Path | None, *, waits: bool) -> None:
        super().__init__(store)
        self.moved = moved
        self.lost, self.altered, self.unstored = store.lost, store.altered, store.unstored
        self._waits = waits  # for its campaign to begin: until then it is that of the one before

    @classmethod
    def create(cls, path: Path, *, meta: Mapping[str, Any], fresh: bool = False) -> Journal:
        """``prepare`` and ``begin`` a campaign at once."""
        journal = cls.prepare(path, meta=meta)
        with journal._store.closed_on_error():
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
        refuse_tracked(path)
        with guarded(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            lock = WriterLock.take(path)
            try:
                moved = make_way(path)
                store = Store.to_write(path, lock)
            except BaseException:
                lock.release()
                raise
            journal = cls(store, moved, waits=not store.is_new)
            with store.closed_on_error():
                if journal._waits:
                    journal._wait()
                else:
                    journal._begin(meta)
        return journal

    def begin(self, meta: Mapping[str, Any], *, fresh: bool = False) -> None:
        """Begin the campaign. Mutants and outcomes of those before are kept aside.

        All or nothing. A complete campaign stays readable as ``previous_of`` the path. ``fresh``: none of the
        outcomes is to be reused.
        """
        if not self._waits:
            return  # nothing was there before
        if self.finished == "complete":
            keep_copy(self._store)
        self._begin(meta)
        self._waits = False
        if fresh:
            self._store.write("UPDATE kept SET key = ''")

    def _wait(self) -> None:
        """The campaign before this one has ended, whatever became of it; the next may fail to begin."""
        if self.finished is None:
            self._store.put(FINISHED_KEY, "killed")
        self._store.put(ATTEMPT_KEY, None)

    def _begin(self, meta: Mapping[str, Any]) -> None:
        with self._store.transaction() as execute:
            if self._waits:
                self._store.remove_unmarked()  # before any of it is believed
                for statement in ADOPT.split(";"):
                    execute(statement)
            self._store.put(VERSION_KEY, SCHEMA_VERSION)
            for key, value in meta.items():
                self._store.put(key, value)

    # What the campaign was and how it ended

    def set_meta(self, key: str, value: Any) -> None:
        """Add or replace one fact about the campaign."""
        self._store.put(key, value)

    def finish(self, reason: str) -> None:
        """Note that the campaign has ended: ``complete``, ``interrupted`` or why it stopped.

        If it has not even begun, the journal stays that of the one before, and tells about the attempt.
        """
        self._store.check()
        if self._store.altered:
            self._store.put(ALTERED, [*(self.meta().get(ALTERED) or []), *self._store.altered])
        self._store.put(ATTEMPT_KEY if self._waits else FINISHED_KEY, reason)

    # The baseline and the plan

    def add_test(self, round: int, repetition: int, test: TestEnd) -> None:
        """Add one test of the baseline; the same test again replaces it."""
        self._store.add(
            "INSERT OR REPLACE INTO test VALUES (?, ?, ?, ?, ?)",
            round, repetition, test.test, test.outcome, dump(test),
        )  # fmt: skip

    def add_control(self, test_file: str, control: str, ok: bool, detail: str = "") -> None:
        """Add the end of one control mutant."""
        self._store.add("INSERT INTO control VALUES (?, ?, ?, ?)", test_file, control, int(ok), detail)

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
        with self._store.transaction() as execute:
            for table in ("mutant", "left_out", "source"):
                execute(f"DELETE FROM {table}")
            for mutant in mutants:
                execute("INSERT INTO mutant VALUES (?, ?, ?)", mutant.number, mutant.id, dump(mutant))
            for item in left_out:
                execute("INSERT INTO left_out VALUES (?, ?, ?)", item.id, item.reason, dump(item))
            for file, text in (sources or {}).items():
                execute("INSERT INTO source VALUES (?, ?)", file, text)

    def keep_planned(self, mutants: Collection[str]) -> None:
        """Leave only these mutants in the plan."""
        with self._store.transaction() as execute:
            for (mutant,) in execute("SELECT id FROM mutant").fetchall():
                if mutant not in mutants:
                    execute("DELETE FROM mutant WHERE id = ?", mutant)

    # Outcomes

    def add_outcome(self, outcome: Outcome, *, key: str = "") -> None:
        """Add one outcome; a later one of the same mutant and round takes its place.

        ``key`` is what it depends on; the empty key says that nobody knows, and that it is not to be reused.
        """
        self._store.add(
            "INSERT INTO outcome VALUES (?, ?, ?, ?, ?, ?, 0)",
            outcome.mutant, outcome.round, outcome.verdict.value, outcome.by.value if outcome.by else None,
            dump(outcome), key,
        )  # fmt: skip

    def add_parts(self, parts: Mapping[str, Mapping[str, str]]) -> None:
        """Write down what digests in keys stand for."""
        for digest, data in parts.items():
            self._store.add("INSERT OR IGNORE INTO parts VALUES (?, ?)", digest, dump(data))

    def forget_keys(self) -> None:
        """Never reuse what this campaign has found itself."""
        self._store.write("UPDATE outcome SET key = '' WHERE NOT reused")

    # Earlier campaigns

    def take_over(self, rows: Iterable[Row]) -> None:
        """Add outcomes of earlier campaigns."""
        with self._store.transaction() as execute:
            for row in rows:
                execute(
                    "INSERT INTO outcome VALUES (?, ?, ?, ?, ?, ?, ?)",
                    row.mutant, row.round, row.verdict, row.by, row.data, row.key,
                    KNOWN_BEFORE,
                )  # fmt: skip

    def add_texts(self, texts: Mapping[str, bytes]) -> None:
        """Write down what stands in Python files, by the digest."""
        with self._store.transaction() as execute:
            for digest, text in texts.items():
                execute("INSERT OR IGNORE INTO text VALUES (?, ?)", digest, zlib.compress(text))

    def forget(self, mutants: Iterable[str]) -> None:
        """Never reuse what earlier campaigns found about these mutants."""
        with self._store.transaction() as execute:
            for mutant in mutants:
                execute("UPDATE kept SET key = '' WHERE mutant = ?", mutant)

    def set_known(self, known: Iterable[tuple[Mutant, bool]]) -> None:
        """Write down the mutants of earlier campaigns that the program still has."""
        with self._store.transaction() as execute:
            execute("DELETE FROM known")
            for mutant, outdated in known:
                execute("INSERT INTO known VALUES (?, ?, ?)", mutant.id, dump(mutant), int(outdated))

    # Shards

    def take_plan(self, other: JournalReader) -> None:
        """Take over the plan of another journal, its baseline and the texts, whole or not at all."""
        with self._store.transaction() as execute:
            for table in ("test", "mutant", "left_out", "source"):
                execute(f"DELETE FROM {table}")
                for row in other._store.rows(f"SELECT * FROM {table} ORDER BY rowid"):
                    execute(f"INSERT INTO {table} VALUES ({', '.join('?' * len(row))})", *row)

    def take_outcomes(self, other: JournalReader) -> None:
        """Take over what another journal has found and knows of earlier campaigns; what is there stays."""
        with self._store.transaction() as execute:
            for question, statement in TAKE.items():
                for row in other._store.rows(question):
                    execute(statement, *row)

    def tidy(self, mutants: Iterable[str]) -> None:
        """Forget what earlier campaigns found about other mutants, and what nothing refers to."""
        with self._store.transaction() as execute:
            known = set(mutants)
            for (mutant,) in execute("SELECT DISTINCT mutant FROM kept").fetchall():
                if mutant not in known:
                    execute("DELETE FROM kept WHERE mutant = ?", mutant)
            keys = execute("SELECT key FROM kept UNION SELECT key FROM outcome").fetchall()
            needed = {digest for (key,) in keys for digest in key.split()}
            for (digest,) in execute("SELECT digest FROM parts").fetchall():
                if digest not in needed:
                    execute("DELETE FROM parts WHERE digest = ?", digest)
            trees = {key.split()[3] for (key,) in keys if len(key.split()) > 3}
            rows = (execute("SELECT data FROM parts WHERE digest = ?", tree).fetchone() for tree in trees)
            texts = {digest for row in rows if row is not None for digest in json.loads(row[0]).values()}
            for (digest,) in execute("SELECT digest FROM text").fetchall():
                if digest not in texts:
                    execute("DELETE FROM text WHERE digest = ?", digest)
