"""Taking outcomes over: with the lines that they name as they are now."""

from __future__ import annotations

from mutabot.campaign.pieces.lines import Lines
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import Row

from .keys import Dependencies, says_same
from .trees import Trees


class TakenOver:
    """Outcomes on their way from one journal to another.

    Attributes:
        rows: those that can be taken over.
    """

    def __init__(self, dependencies: Dependencies) -> None:
        self.rows: list[Row] = []
        self._dependencies = dependencies
        self._trees = Trees(dependencies)
        self._lines: dict[str, Lines | None] = {}

    def take(self, source: JournalReader, pair: tuple[str, int], key: str, now: tuple[str, ...]) -> bool:
        """Take one over; returns False if it names a line that nobody can find."""
        row = source.row(*pair)
        tree = key.rsplit(maxsplit=1)[-1]
        if tree != self._dependencies.tree:
            lines = self._lines_from(source, tree)
            data = lines.moved(row.data) if lines is not None else None
            if data is None:
                return False
            row = row.with_data(data)
        self.rows.append(row.with_key(next(one for one in now if says_same(one, key))))
        return True

    def _lines_from(self, source: JournalReader, tree: str) -> Lines | None:
        if tree not in self._lines:
            old = self._trees.reach(source, tree)
            new = self._dependencies.reach.project
            self._lines[tree] = Lines(old.project, new) if old is not None else None
        return self._lines[tree]
