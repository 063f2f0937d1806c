"""Print the lines of mutants while a campaign runs, each as soon as its state is final."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING

from mutabot.report.texts import Cleaner, mapped, state_of
from mutabot.results.divergence import explain, quantity_of
from mutabot.results.results import MutantResult

from .formats import jsonl, lines

if TYPE_CHECKING:
    from mutabot.model import Outcome, Vocabulary
    from mutabot.model.mutant_end import MutantEnd
    from mutabot.results.results import Results

#: the formats that can be streamed
STREAMED: dict[str, ModuleType] = {"lines": lines, "jsonl": jsonl}


class MutantStream:
    """Prints a line per mutant, and a last line; of several lines of a mutant, the last counts.

    A survivor is one with its first round; all others are settled by their last round. What a second look
    changes comes at the end.

    Args:
        name: one of ``STREAMED``.
        rounds: number of rounds.
        vocabulary: that of the campaign.
        root: the project, of which paths say nothing.
        write: takes a line.
    """

    def __init__(
        self, name: str, rounds: int, vocabulary: Vocabulary, root: str, write: Callable[[str], None]
    ) -> None:
        self._format, self._write = STREAMED[name], write
        self._vocabulary, self._clean = vocabulary, Cleaner(root)
        self._rounds = rounds
        self._waiting: dict[str, list[Outcome | None]] = {}
        self._states: dict[str, str] = {}

    def add(self, end: MutantEnd) -> None:
        """Print the line of a mutant if its state is final now."""
        mutant = end.mutant
        if mutant.id in self._states or mutant.has_sizes or end.outcome.round >= self._rounds:
            return
        row = self._waiting.setdefault(mutant.id, [None] * self._rounds)
        row[end.outcome.round] = end.outcome
        known = [outcome for outcome in row if outcome is not None]
        result = MutantResult(
            mutant,
            tuple(row),
            quantity_of(mutant, self._vocabulary),
            explain(mutant, known, self._vocabulary),
            acceptance=end.acceptance,
        )
        if result.lets_through or None not in row:
            del self._waiting[mutant.id]
            self._print(result)

    def finish(self, results: Results) -> None:
        """Print the lines of mutants that have changed their state or lack a line, and the last line."""
        for result in results.mutants:
            if self._states.get(result.mutant.id) != state_of(result):
                self._print(result)
        self._write(self._format.end_line(results))

    def _print(self, result: MutantResult) -> None:
        self._states[result.mutant.id] = state_of(result)
        self._write(self._format.mutant_line(mapped(result, self._clean)))
