"""What a journal is asked: the campaign, its baseline, plan and outcomes, and what is known from before."""

from __future__ import annotations

import errno
import json
import os
import zlib
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from mutabot.border.codec import from_data
from mutabot.border.test_end import TestEnd
from mutabot.model import LeftOut, Mutant, Outcome, Verdict, Vocabulary

from .records import BaselineTest, ControlEnd, Kept, Row
from .schema import ATTEMPT_KEY, FINISHED_KEY, LAST, PRESUMED
from .store import Store


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
        rows = self._store.rows("SELECT key, value FROM meta")
        return {key: json.loads(value) for key, value in rows if not key.startswith("journal:")}

    @property
    def vocabulary(self) -> Vocabulary | None:
        """The vocabulary of the campaign, if it was written down."""
        data = self.meta().get("vocabulary")
        return from_data(Vocabulary, data) if data is not None else None

    @property
    def finished(self) -> str | None:
        """Why the campaign ended; None while it runs and after it was killed."""
        found = self._store.fact(FINISHED_KEY)
        return None if found is None else str(found)

    @property
    def attempt(self) -> str | None:
        """Why a later campaign ended before it had begun; empty if it was killed or is about to begin.

        None if there was no such campaign.
        """
        rows = self._store.rows("SELECT value FROM meta WHERE key = ?", ATTEMPT_KEY)
        return str(json.loads(rows[0][0]) or "") if rows else None

    # The baseline and the plan

    def tests(self) -> list[BaselineTest]:
        """The tests of the baseline in the order they were added."""
        rows = self._store.rows("SELECT round, repetition, data FROM test ORDER BY rowid")
        return [
            BaselineTest(round, repetition, from_data(TestEnd, json.loads(data)))
            for round, repetition, data in rows
        ]

    def controls(self) -> list[ControlEnd]:
        """The controls in the order they were added."""
        rows = self._store.rows("SELECT test_file, control, ok, detail FROM control ORDER BY rowid")
        return [ControlEnd(file, control, bool(ok), detail) for file, control, ok, detail in rows]

    def mutants(self) -> list[Mutant]:
        """The planned mutants by number."""
        return self._store.read(Mutant, "SELECT data FROM mutant ORDER BY number, rowid")

    def left_out(self) -> list[LeftOut]:
        """What the plan leaves out, in its order."""
        return self._store.read(LeftOut, "SELECT data FROM left_out ORDER BY rowid")

    def source(self, file: str) -> str | None:
        """The text of a mutated file at the time of the campaign, or None if it was not written down."""
        rows = self._store.rows("SELECT text FROM source WHERE file = ?", file)
        return str(rows[0][0]) if rows else None

    # Outcomes

    def outcomes(self) -> list[Outcome]:
        """The last outcome of each (mutant, round), in the order they came."""
        return self._store.read(Outcome, f"SELECT data FROM outcome WHERE rowid IN ({LAST}) ORDER BY rowid")

    def reused(self) -> set[tuple[str, int]]:
        """The mutants and rounds whose outcomes were taken over from an earlier campaign."""
        return set(self._store.rows(f"SELECT mutant, round FROM outcome WHERE reused AND rowid IN ({LAST})"))

    def presumed(self) -> set[tuple[str, int]]:
        """Those of them that are only presumed to be what they would be now."""
        return set(
            self._store.rows(
                f"SELECT mutant, round FROM outcome WHERE reused = {PRESUMED} AND rowid IN ({LAST})"
            )
        )

    # Earlier campaigns

    def kept(self) -> dict[tuple[str, int], Kept]:
        """The last outcome of each mutant and round that earlier campaigns found, if it can be reused."""
        return self._of_rows("SELECT mutant, round, verdict, data, key FROM kept")

    def found(self) -> dict[tuple[str, int], Kept]:
        """The same, with those that the last campaign itself found or knew."""
        return self.kept() | self._of_rows(
            f"SELECT mutant, round, verdict, data, key FROM outcome "
            f"WHERE rowid IN ({LAST}) AND reused != {PRESUMED}"
        )

    def row(self, mutant: str, round: int) -> Row:
        """One of those that were ``found``."""
        for table, condition in (("outcome", f"AND reused != {PRESUMED} ORDER BY rowid DESC"), ("kept", "")):
            rows = self._store.rows(
                f'SELECT verdict, "by", data, key FROM {table} '
                f"WHERE mutant = ? AND round = ? AND key != '' {condition} LIMIT 1",
                mutant, round,
            )  # fmt: skip
            if rows:
                return Row(mutant, round, *rows[0])
        raise KeyError((mutant, round))

    def _of_rows(self, question: str) -> dict[tuple[str, int], Kept]:
        rows = self._store.rows(
            "SELECT mutant, round, key, verdict NOT IN ('error', 'unstable') AND data NOT LIKE ?, verdict "
            f"FROM ({question}) WHERE key != ''",
            f"%{os.strerror(errno.ENOSPC)}%",
        )
        return {
            (mutant, round): Kept(key, bool(sound), Verdict(verdict))
            for mutant, round, key, sound, verdict in rows
        }

    def kept_outcomes(self) -> list[Outcome]:
        """All that earlier campaigns found, also what cannot be reused."""
        return self._store.read(Outcome, "SELECT data FROM kept")

    def known(self) -> list[tuple[Mutant, bool]]:
        """Mutants of earlier campaigns, and whether something has changed since that they depend on."""
        rows = self._store.rows("SELECT data, outdated FROM known ORDER BY rowid")
        return [(from_data(Mutant, json.loads(data)), bool(outdated)) for data, outdated in rows]

    def parts(self, digest: str) -> dict[str, str] | None:
        """What a digest in a key stands for, or None if that is not known any more."""
        rows = self._store.rows("SELECT data FROM parts WHERE digest = ?", digest)
        return dict(json.loads(rows[0][0])) if rows else None

    def text(self, digest: str) -> bytes | None:
        """What stood in a Python file with this digest, or None if that is not known any more."""
        rows = self._store.rows("SELECT data FROM text WHERE digest = ?", digest)
        return zlib.decompress(rows[0][0]) if rows else None
