"""A reader of the journal: the campaign, its plan, its outcomes, and earlier ones."""

from __future__ import annotations

import errno
import os
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Self, TypeVar

from mutabot.errors import JournalError
from mutabot.journal.row_checks import UNFIT
from mutabot.model import LeftOut, Mutant, Outcome, Verdict, Vocabulary
from mutabot.model.codec import from_data

from . import database, row_checks
from .database import LAST, columns
from .files import refuse_tracked
from .records import BaselineTest, ControlEnd, Kept, KeptBaseline, OriginalRun

T = TypeVar("T")
#: a key of meta that is the journal's own: why the campaign ended
FINISHED_KEY = "journal:finished"
#: of a campaign that has not begun yet: why it ended, null as long as it has not
ATTEMPT_KEY = "journal:attempt"
#: of a journal in which there is a baseline, and no campaign yet
NONE_YET_KEY = "journal:none yet"


class JournalReader:
    """A reader of the record of a campaign; use as a context manager.

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
        """Open the current state of an existing journal, which may be written meanwhile.

        ``of_campaign``: whether there must be more in it than a baseline.
        """
        if not path.is_file():
            raise database.no_journal(path)
        refuse_tracked(path)
        with database.guarded(path), ExitStack() as opened:
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
        """Close the file, and release a writer's lock."""
        self._copy.close()

    # What the campaign was and how it ended

    def meta(self) -> dict[str, Any]:
        """Return the campaign's description of itself."""
        found = {}
        for key, text in self._rows("SELECT key, value FROM meta"):
            if isinstance(key, str) and not key.startswith("journal:"):
                with self._checked("meta", key):
                    found[key] = row_checks.fact(key, row_checks.load(text))
        return {key: value for key, value in found.items() if value is not None}

    @property
    def vocabulary(self) -> Vocabulary | None:
        """The vocabulary of the campaign, if it was written down."""
        found: Vocabulary | None = self.meta().get("vocabulary")
        return found

    @property
    def finished(self) -> str | None:
        """Why the campaign ended; None while it runs and after it was killed."""
        return self._one("meta", FINISHED_KEY, lambda text: str(row_checks.load(text)))

    @property
    def attempt(self) -> str | None:
        """Why a later campaign ended before it had begun; empty if it was killed or is about to begin.

        None if there was no such campaign.
        """
        rows = self._rows("SELECT value FROM meta WHERE key = ?", ATTEMPT_KEY)
        with self._checked("meta", ATTEMPT_KEY):
            return str(row_checks.load(rows[0][0]) or "") if rows else None
        return ""

    # The baseline and the plan

    def tests(self) -> list[BaselineTest]:
        """Return the tests of the baseline in the order they were added."""
        return self._all("test", BaselineTest)

    def controls(self) -> list[ControlEnd]:
        """Return the controls in the order they were added."""
        return self._all("control", ControlEnd)

    def mutants(self) -> list[Mutant]:
        """Return the planned mutants by number."""
        return sorted(self._all("mutant", Mutant), key=lambda mutant: mutant.number)

    def left_out(self) -> list[LeftOut]:
        """Return the mutants that the plan leaves out, in its order."""
        return self._all("left_out", LeftOut)

    def source(self, file: str) -> str | None:
        """Return the text of a mutated file at the time of the campaign; None if it was not recorded."""
        return self._one("source", file, row_checks.text_in)

    def original(self) -> KeptBaseline | None:
        """Return the runs of the original that are kept; None if there are none."""
        head, runs = None, []
        for task, data, events in self._rows("SELECT task, data, events FROM original ORDER BY rowid"):
            with self._checked("original", task):
                row = {"task": task, "data": data}
                if task:
                    run = row_checks.held(OriginalRun, row)
                    runs.append(replace(run, events=bytes(memoryview(events))))
                else:
                    head = row_checks.held(KeptBaseline, {"data": data})
        return replace(head, runs=tuple(runs)) if head is not None else None

    # Outcomes

    def outcomes(self) -> list[Outcome]:
        """Return the last outcome of each (mutant, round), in the order they came."""
        return self._all("outcome", Outcome, f"WHERE rowid IN ({LAST}) ORDER BY rowid")

    def rounds_known(self) -> dict[str, int]:
        """Count the rounds in which each mutant has an outcome; mutants without any are missing."""
        return dict(self._rows("SELECT mutant, count(DISTINCT round) FROM outcome GROUP BY mutant"))

    def reused(self) -> set[tuple[str, int]]:
        """Return the mutants and rounds whose outcomes were taken over from an earlier campaign."""
        return set(self._rows(f"SELECT mutant, round FROM outcome WHERE reused AND rowid IN ({LAST})"))

    # Earlier campaigns

    def kept(self) -> dict[tuple[str, int], Kept]:
        """Return the last reusable outcome of each mutant and round from earlier campaigns."""
        return self._kept_in("kept", "1")

    def found(self) -> dict[tuple[str, int], Kept]:
        """Return the kept outcomes and those that the last campaign itself found or reused."""
        return self.kept() | self._kept_in("outcome", f"rowid IN ({LAST})")

    def row(self, mutant: str, round: int) -> Kept | None:
        """Return one of the rows ``found``, with its data; None for an invalid row."""
        for table in ("outcome", "kept"):
            rows = self._rows(
                f"SELECT verdict, data, key FROM {table} WHERE mutant = ? AND round = ? AND key != '' "
                "ORDER BY rowid DESC LIMIT 1",
                mutant, round,
            )  # fmt: skip
            for verdict, data, key in rows:
                with self._checked(table, mutant, round):
                    row = {"mutant": mutant, "round": round, "verdict": verdict, "data": data}
                    return Kept(mutant, round, row_checks.held(Outcome, row).verdict, key, data=data)
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
                pair = row_checks.text_in(mutant), row_checks.round_in(round)
                found[pair] = Kept(*pair, Verdict(verdict), row_checks.text_in(key), bool(is_sound))
        return found

    def kept_outcomes(self) -> list[Outcome]:
        """Return all outcomes of earlier campaigns, even those that cannot be reused."""
        return self._all("kept", Outcome)

    def known(self) -> list[tuple[Mutant, bool]]:
        """Return mutants of earlier campaigns, and whether something that they depend on has changed."""
        outdated = {name for (name,) in self._rows("SELECT id FROM known WHERE outdated != 0")}
        return [(mutant, mutant.id in outdated) for mutant in self._all("known", Mutant)]

    def parts(self, digest: str) -> dict[str, str] | None:
        """Return the content behind a digest in a key; None if it is no longer stored."""
        return self._one("parts", digest, lambda text: from_data(dict[str, str], row_checks.load(text)))

    def text(self, digest: str) -> bytes | None:
        """Return the content of a Python file with this digest; None if it is no longer stored."""
        return self._one("text", digest, lambda data: bytes(memoryview(data)))

    # Rows

    @property
    def _is_of_none(self) -> bool:
        """Whether no campaign has begun in it yet."""
        return bool(self._rows("SELECT 1 FROM meta WHERE key = ?", NONE_YET_KEY))

    def _rows(self, statement: str, *values: Any) -> list[Any]:
        """Return the rows that a statement selects."""
        with database.guarded(self.path):
            return self._copy.execute(statement, database.stored(values)).fetchall()

    def _all(self, table: str, kind: type[T], which: str = "ORDER BY rowid") -> list[T]:
        """Return the objects that the rows of a table hold."""
        found = []
        for row in self._rows(f"SELECT * FROM {table} {which}"):
            with self._checked(table, *row):
                found.append(row_checks.held(kind, dict(zip(columns()[table], row, strict=True))))
        return found

    def _one(self, table: str, name: str, read: Callable[[Any], T]) -> T | None:
        """Return the value of a name in a table of names and values; None if it is missing or invalid."""
        key, value = columns()[table]
        with self._checked(table, name):
            for (found,) in self._rows(f"SELECT {value} FROM {table} WHERE {key} = ?", name):
                return read(found)
        return None

    @contextmanager
    def _checked(self, table: str, *values: Any) -> Iterator[None]:
        """Skip an invalid row and continue with the next; the row's first values name it."""
        try:
            yield
        except UNFIT:
            self._unfit[f"{database.named_row(table, values)}"] = None


def kept_original(path: Path) -> KeptBaseline | None:
    """Return the runs of the original that a journal keeps; None if there are none or it is unusable."""
    with suppress(JournalError), JournalReader.open(path, of_campaign=False) as journal:
        return journal.original()
    return None
