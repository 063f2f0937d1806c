"""Stored campaigns: the content of a journal as one object, with recordings, and as a table.

The table has one row per mutant and round that has been run; docs/reports.md has its columns. Names and units
are stable: columns may be added, at the end.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import lru_cache
from html import escape
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from mutabot.errors import plural
from mutabot.evidence.recording import Recording, from_bytes
from mutabot.frozen import frozen
from mutabot.journal.files import find_journal
from mutabot.journal.recordings import ORIGINAL, Recordings
from mutabot.model.codec import shallow
from mutabot.results.encoder import Encoder
from mutabot.results.results import Results
from mutabot.results.score import percent
from mutabot.thresholds.thresholds import Thresholds, thresholds_of

if TYPE_CHECKING:
    from mutabot.results.score import Group

#: recordings that are held; survivors that a notebook shows by itself
_HELD, _SHOWN = 32, 10


class StoredEvidence:
    """All recordings of a campaign, to be closed after use. Raises JournalError if they cannot be read.

    Args:
        journal: the path of its journal.
    """

    def __init__(self, journal: Path) -> None:
        self._recordings = Recordings.to_read(journal)
        self.recording = lru_cache(_HELD)(self._read)

    def close(self) -> None:
        """Close the file."""
        if self._recordings is not None:
            self._recordings.close()

    def tests(self, mutant: str, round: int) -> tuple[str, ...]:
        """Return the tests with recordings in which a mutant, by its id, differed in a round (from 0)."""
        return self._recordings.tests(mutant, round) if self._recordings is not None else ()

    def has_original(self) -> bool:
        """Return whether anything is recorded of the original: if not, nothing is of mutants."""
        pairs = self._recordings.pairs() if self._recordings is not None else []
        return any(mutant == ORIGINAL for mutant, _ in pairs)

    def pair(self, mutant: str, round: int, test: str) -> tuple[Recording | None, Recording | None]:
        """Return the recordings of one test, as the original and as a mutant.

        None if there is none; of a mutant also if nothing in it differs, or if there was no room for it.
        """
        return self.recording(ORIGINAL, round, test), self.recording(mutant, round, test)

    def _read(self, mutant: str, round: int, test: str) -> Recording | None:
        data = self._recordings.data(mutant, round, test) if self._recordings is not None else None
        return from_bytes(data) if data is not None else None


_LINE = (
    "mutant=mutant.id number=mutant.number round=outcome.round+1 family=mutant.family role=mutant.site.role "
    "operator=mutant.operator variant=mutant.variant file=mutant.site.span.file line=mutant.site.span.line "
    "column=mutant.site.span.column+1 function=mutant.site.span.function call=mutant.site.text "
    "operation=mutant.operation? quantity=mutant.quantity unit=quantity.unit description=mutant.description "
    "verdict=outcome.verdict by=outcome.by valid=outcome.verdict.is_valid killed=outcome.verdict.is_killed "
    "test=outcome.test exception=outcome.exception message=outcome.message place=outcome.place "
    "hits=outcome.hits acted=outcome.acted before after tests=outcome.tests wall_s=outcome.wall "
    "cpu_s=outcome.cpu simulated_s=outcome.simulated distance=outcome.distance way=outcome.way "
    "indistinguishable=outcome.indistinguishable divergence commands=outcome.commands engine=outcome.engine "
    "repeats=outcome.repeats confirmed=outcome.confirmed magnitude=mutant.magnitude "
    "magnitude_unit=mutant.unit direction=mutant.direction? accepted=accepted.why "
    "deviation=outcome.deviation"
)
#: the columns of the table by their stable names, in the order of files; one with a unit ends in it
COLUMNS = tuple(word.partition("=")[0] for word in _LINE.split())
_FACTS = Encoder({})


def rows(results: Results) -> Iterator[dict[str, Any]]:
    """Yield the cells of all outcomes by column, by mutant, then by round. None is a missing value."""
    for result in results.everything:
        for outcome in result.outcomes:
            example = outcome.example if outcome.example is not None and len(outcome.example) == 2 else ()
            before, after = map(str, example) if example else (None, None)
            row = SimpleNamespace(
                mutant=result.mutant, quantity=result.quantity, outcome=outcome, before=before, after=after,
                divergence=next(iter(outcome.divergence), None),
                accepted=result.acceptance if result.is_accepted else None,
            )  # fmt: skip
            cells = _FACTS.facts(row, _LINE)
            is_number = {
                key: not isinstance(cell, float) or math.isfinite(cell) for key, cell in cells.items()
            }
            yield {key: cell if is_number[key] else None for key, cell in cells.items()}


@frozen
class StoredCampaign(Results):
    """The last campaign of a journal, for notebooks. It does not change."""

    @property
    def scores(self) -> tuple[Group, ...]:
        """Scores per family and role, which are never combined."""
        return self.groups

    @property
    def thresholds(self) -> Thresholds:
        """The ladders of graded mutants, least sensitive first."""
        return thresholds_of(self)

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {name}" for name, count in self._counts.items())
        size = f"{plural(len(self.mutants), 'mutant')} × {plural(self.rounds, 'round')}"
        return f"<campaign, {self.state}: {size}: {counts}>"

    def _repr_html_(self) -> str:
        """Return scores and the first survivors as HTML, for notebooks."""
        scores = [
            (f"{group.family} · {group.role}", str(group.mutants), percent(group.scores.mean),
             percent(group.scores.mean_check), str(group.scores.accepted))
            for group in self.groups
        ]  # fmt: skip
        first = self.survivors[:_SHOWN]
        survivors = [
            (str(result.mutant.number), result.mutant.site.span.place, result.mutant.operator,
             result.mutant.description, result.why)
            for result in first
        ]  # fmt: skip
        left = len(self.survivors) - len(first)
        return "".join(
            [
                f"<p>{escape(repr(self)[1:-1])}</p>",
                _table(("family · role", "mutants", "score", "check score", "accepted"), scores),
                _table(("no.", "place", "operator", "survivor", "effect"), survivors),
                f"<p>and {plural(left, 'more survivor')}</p>" if left else "",
            ]
        )

    @property
    def _counts(self) -> dict[str, int]:
        """The counts of mutants by state."""
        states = ("accepted" if result.is_accepted else result.status or "not run" for result in self.mutants)
        return dict(Counter(map(str, states)))

    def rows(self) -> list[dict[str, Any]]:
        """Return one row per outcome, by column, as in docs/reports.md. ``pandas.DataFrame`` takes this."""
        return list(rows(self))


def _table(head: Sequence[str], found: Sequence[Sequence[str]]) -> str:
    """Return an HTML table; nothing without rows."""
    if not found:
        return ""
    lines = (
        "".join(f"<{kind}>{escape(cell)}</{kind}>" for cell in row)
        for kind, row in (("th", head), *(("td", row) for row in found))
    )
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def open(path: str | Path = ".") -> StoredCampaign:
    """Read the last campaign of a journal, which may be interrupted or still running.

    ``path`` is a project's folder, a folder inside it, or the file of a journal.

    Raises JournalError if there is no journal, or none that this version reads.
    """
    journal = find_journal(Path(path)) if Path(path).is_dir() else Path(path)
    return StoredCampaign(**shallow(Results.read(journal)))
