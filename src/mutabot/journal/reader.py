"""What a journal is asked: the campaign, its baseline, plan and outcomes, and what is known from before."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

from mutabot.model import LeftOut, Mutant, Outcome, Verdict, Vocabulary
from mutabot.model.codec import from_data

from .database import ATTEMPT_KEY, FINISHED_KEY, LAST
from .fitting import (
    UNFIT,
    baseline_test_in,
    control_in,
    fact,
    inflated,
    known_in,
    left_out_in,
    load,
    outcome_in,
    planned_in,
    round_in,
    text_in,
)
from .marks import name_of, word_for
from .records import BaselineTest, ControlEnd, Kept, Row
from .store import Store

T = TypeVar("T")


class JournalReader:
    """The record of one campaign, to be read; use as a context manager.

    Every method raises JournalError when the file cannot be read.

    Attributes:
        path: the file.
    """

    def __init__(self, store: Store) -> None:
        self.path, self._store = store.path, store
        self._unfit: dict[str, None] = {}

    @property
    def set_aside(self) -> list[str]:
        """Rows that were not written by Mutabot, or that hold what cannot be, in words: nobody believes them.

        What a row holds is looked at when it is read.
        """
        return [*self._store.unmarked, *self._unfit]

    @staticmethod
    def open(path: Path) -> JournalReader:
        """Open an existing journal. It may be written meanwhile."""
        return JournalReader(Store.to_read(path))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
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
                    found[key] = fact(key, load(text))
        return {key: value for key, value in found.items() if value is not None}

    @property
    def vocabulary(self) -> Vocabulary | None:
        """The vocabulary of the campaign, if it was written down."""
        data = self.meta().get("vocabulary")
        return from_data(Vocabulary, data) if data is not None else None

    @property
    def finished(self) -> str | None:
        """Why the campaign ended; None while it runs and after it was killed."""
        with self._checked("meta", FINISHED_KEY):
            found = self._store.fact(FINISHED_KEY)
            return None if found is None else str(found)
        return None

    @property
    def attempt(self) -> str | None:
        """Why a later campaign ended before it had begun; empty if it was killed or is about to begin.

        None if there was no such campaign.
        """
        rows = self._store.rows("SELECT value FROM meta WHERE key = ?", ATTEMPT_KEY)
        with self._checked("meta", ATTEMPT_KEY):
            return str(load(rows[0][0]) or "") if rows else None
        return ""

    # The baseline and the plan

    def tests(self) -> list[BaselineTest]:
        """The tests of the baseline in the order they were added."""
        return self._all("test", baseline_test_in)

    def controls(self) -> list[ControlEnd]:
        """The controls in the order they were added."""
        return self._all("control", control_in)

    def mutants(self) -> list[Mutant]:
        """The planned mutants by number."""
        return self._all("mutant", planned_in, "ORDER BY number, rowid")

    def left_out(self) -> list[LeftOut]:
        """What the plan leaves out, in its order."""
        return self._all("left_out", left_out_in)

    def source(self, file: str) -> str | None:
        """The text of a mutated file at the time of the campaign, or None if it was not written down."""
        rows = self._store.rows("SELECT text FROM source WHERE file = ?", file)
        with self._checked("source", file):
            return text_in(rows[0][0]) if rows else None
        return None

    # Outcomes

    def outcomes(self) -> list[Outcome]:
        """The last outcome of each (mutant, round), in the order they came."""
        return self._all("outcome", outcome_in, f"WHERE rowid IN ({LAST}) ORDER BY rowid")

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

    def row(self, mutant: str, round: int) -> Row | None:
        """One of those that were ``found``; None if it holds what no outcome can."""
        for table, condition in (("outcome", "ORDER BY rowid DESC"), ("kept", "")):
            rows = self._store.rows(
                f'SELECT verdict, "by", data, key FROM {table} '
                f"WHERE mutant = ? AND round = ? AND key != '' {condition} LIMIT 1",
                mutant, round,
            )  # fmt: skip
            for verdict, by, text, key in rows:
                with self._checked(table, mutant, round):
                    outcome_in(mutant, round, verdict, by, text)
                    return Row(mutant, round, verdict, by, text, key)
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
                found[text_in(mutant), round_in(round)] = Kept(text_in(key), bool(sound), Verdict(verdict))
        return found

    def kept_outcomes(self) -> list[Outcome]:
        """All that earlier campaigns found, also what cannot be reused."""
        return self._all("kept", outcome_in)

    def known(self) -> list[tuple[Mutant, bool]]:
        """Mutants of earlier campaigns, and whether something has changed since that they depend on."""
        return self._all("known", known_in)

    def parts(self, digest: str) -> dict[str, str] | None:
        """What a digest in a key stands for, or None if that is not known any more."""
        rows = self._store.rows("SELECT data FROM parts WHERE digest = ?", digest)
        with self._checked("parts", digest):
            return from_data(dict[str, str], load(rows[0][0])) if rows else None
        return None

    def text(self, digest: str) -> bytes | None:
        """What stood in a Python file with this digest, or None if that is not known any more."""
        rows = self._store.rows("SELECT data FROM text WHERE digest = ?", digest)
        with self._checked("text", digest):
            return inflated(rows[0][0]) if rows else None
        return None

    def _all(self, table: str, read: Callable[..., T], which: str = "ORDER BY rowid") -> list[T]:
        """What the rows of a table hold, from all their columns."""
        found = []
        for row in self._store.rows(f"SELECT * FROM {table} {which}"):
            with self._checked(table, *row):
                found.append(read(*row))
        return found

    @contextmanager
    def _checked(self, table: str, *values: Any) -> Iterator[None]:
        """Leave a row that holds what cannot be, and go on with the next; the first values name it."""
        try:
            yield
        except UNFIT:
            self._unfit[f"{word_for(table)} {name_of(table, values)}"] = None
