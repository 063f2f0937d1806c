"""A campaign as its journal holds it: what reports are made from, and what ``mutabot.open`` gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mutabot.analysis.results import MutantResult, Results, find_mutant, read_results
from mutabot.analysis.score import Group
from mutabot.analysis.thresholds.thresholds import Thresholds, thresholds_of
from mutabot.border.codec import from_data
from mutabot.frozen import frozen
from mutabot.journal.files import find_journal
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import DRAWS, OPERATORS, REACHING, Reaching
from mutabot.model import Mutant, Outcome

from .table import frame_of

if TYPE_CHECKING:
    import pandas


@frozen
class StoredCampaign:
    """The last campaign of a journal, as it was when it was read. Nothing of it changes later.

    Attributes:
        results: all that reports tell.
        sources: text of the mutated files at the time of the campaign, by path relative to the project.
        operators: what each operator does, in a sentence, by its name; those of journals that do not say it
            are missing.
        reaching: which tests reach which sites.
        draws: names of operators that draw a number for each round.
    """

    results: Results
    sources: Mapping[str, str] = field(default_factory=dict)
    operators: Mapping[str, str] = field(default_factory=dict)
    reaching: Reaching = field(default_factory=Reaching)
    draws: frozenset[str] = frozenset()

    @property
    def meta(self) -> Mapping[str, Any]:
        """What the campaign said about itself: ``seed``, ``rounds``, ``engine``, ``versions`` …"""
        return self.results.meta

    @property
    def state(self) -> str:
        """``complete``, ``interrupted``, ``running``, ``killed`` or why it stopped."""
        return self.results.state

    @property
    def is_complete(self) -> bool:
        """Whether the campaign ran to its end."""
        return self.state == "complete"

    @property
    def rounds(self) -> int:
        """Number of rounds."""
        return self.results.rounds

    @property
    def mutants(self) -> tuple[MutantResult, ...]:
        """Every planned mutant with what became of it, by number; graded ones have ``thresholds``."""
        return self.results.mutants

    @property
    def outcomes(self) -> tuple[Outcome, ...]:
        """Every outcome there is: by mutant, then by round."""
        return tuple(outcome for result in self.results.everything for outcome in result.outcomes)

    @property
    def survivors(self) -> tuple[MutantResult, ...]:
        """Mutants that some round lets through, the farthest from the original first."""
        return tuple(self.results.survivors)

    @property
    def scores(self) -> tuple[Group, ...]:
        """Scores per family and role. They are never added up."""
        return self.results.groups

    @property
    def thresholds(self) -> Thresholds:
        """The ladders of graded mutants, the loosest first."""
        return thresholds_of(self.results)

    def mutant(self, name: str) -> MutantResult:
        """The mutant with this number or id, or the only one that a part of an id fits.

        Raises SelectionError if there is none or more than one.
        """
        return find_mutant(self.results, name)

    def source(self, file: str) -> str | None:
        """The text of a mutated file at the time of the campaign; None if it was not written down."""
        return self.sources.get(file)

    def reached_by(self, mutant: Mutant) -> tuple[str, ...]:
        """Node ids of the tests that reach a mutant in any round, as far as the journal says."""
        return self.reaching.at(mutant.site.id)

    def frame(self) -> pandas.DataFrame:
        """One row per outcome; docs/reports.md has the columns. Needs pandas: ``mutabot[notebook]``.

        Raises UsageError if pandas is not installed.
        """
        return frame_of(self.results)


def journal_at(path: Path) -> Path:
    """The journal that a user means by a path: a journal, or a project's folder or a folder inside it."""
    return find_journal(path) if path.is_dir() else path


def open(path: str | Path = ".") -> StoredCampaign:
    """Read the last campaign of a journal, also one that was interrupted or still runs.

    ``path`` is a project's folder, a folder inside it, or the file of a journal.

    Raises JournalError if there is no journal, or none that this version reads.
    """
    with JournalReader.open(journal_at(Path(path))) as journal:
        results = read_results(journal)
        files = {one.mutant.site.span.file for one in results.everything}
        found = {file: journal.source(file) for file in sorted(files)}
    meta = results.meta
    return StoredCampaign(
        results,
        sources={file: text for file, text in found.items() if text is not None},
        operators=meta.get(OPERATORS, {}),
        reaching=from_data(Reaching, meta[REACHING]) if REACHING in meta else Reaching(),
        draws=frozenset(meta.get(DRAWS, ())),
    )
