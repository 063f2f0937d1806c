"""The recordings beside a journal, to be read: of the original and of mutants that differ from it."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from types import TracebackType
from typing import Self

from mutabot.evidence.recording import Recording, from_bytes
from mutabot.frozen import frozen
from mutabot.journal.recordings import ORIGINAL, Recordings

#: recordings that are held
_HELD = 32


@frozen
class Pair:
    """One test, as the original and as a mutant.

    Attributes:
        test: node id.
        original: its recording; None if there is none.
        mutant: the mutant's; None if nothing in it differs, or if there was no room for it.
    """

    test: str
    original: Recording | None
    mutant: Recording | None


class StoredEvidence:
    """All recordings of a campaign; use as a context manager. Raises JournalError if they cannot be read.

    Args:
        journal: the path of its journal.
    """

    def __init__(self, journal: Path) -> None:
        self._recordings = Recordings.to_read(journal)
        self.recording = lru_cache(_HELD)(self._read)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        if self._recordings is not None:
            self._recordings.close()

    def tests(self, mutant: str, round: int) -> tuple[str, ...]:
        """The tests in which a mutant, by its id, differed in a round (from 0), if they were recorded."""
        return self._recordings.tests(mutant, round) if self._recordings is not None else ()

    def pair(self, mutant: str, round: int, test: str) -> Pair:
        """One test, as the original and as a mutant."""
        return Pair(test, self.recording(ORIGINAL, round, test), self.recording(mutant, round, test))

    def _read(self, mutant: str, round: int, test: str) -> Recording | None:
        data = self._recordings.data(mutant, round, test) if self._recordings is not None else None
        return from_bytes(data) if data is not None else None
