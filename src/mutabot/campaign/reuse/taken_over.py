"""Taking outcomes over, with the lines that they name as they are now."""

from __future__ import annotations

from dataclasses import replace

from mutabot.campaign.pieces.lines import Lines
from mutabot.campaign.pieces.reach import Reach
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import Row
from mutabot.model import Mutant, Verdict

from .keys import Dependencies


class Trees:
    """What tests could run in earlier states of the files."""

    def __init__(self, dependencies: Dependencies) -> None:
        self._dependencies = dependencies
        self._known: dict[str, Reach | None] = {}

    def reach(self, journal: JournalReader, tree: str) -> Reach | None:
        """By the digest of the files; None if the journal does not hold them all any more."""
        if tree not in self._known:
            self._known[tree] = self._read(journal, tree)
        return self._known[tree]

    def says_same(self, journal: JournalReader, tree: str) -> bool:
        """Whether all files say what they say now, comments and layout aside."""
        now = self._dependencies
        old = self.reach(journal, tree) if tree != now.tree else now.reach
        return old is not None and old.whole == now.reach.whole

    def _read(self, journal: JournalReader, tree: str) -> Reach | None:
        files = journal.parts(tree)
        if files is None:
            return None
        texts = {name: journal.text(digest) for name, digest in files.items()}
        known = {name: text for name, text in texts.items() if text is not None}
        return self._dependencies.reach_of(files, known) if len(known) == len(files) else None


Pair = tuple[str, int]


class TakenOver:
    """Outcomes on their way from one journal to another.

    Attributes:
        rows: those that can be taken over.
        unasked: how many of them are survivors that some tests do not reach, while something has changed that
            only these could notice.
    """

    def __init__(self, dependencies: Dependencies) -> None:
        self.rows: list[Row] = []
        self.unasked = 0
        self._dependencies = dependencies
        self._trees = Trees(dependencies)
        self._lines: dict[str, Lines | None] = {}

    def take(self, source: JournalReader, mutant: Mutant, round: int, key: str, now: str) -> bool:
        """Take one over; returns False if it names a line that nobody can find, or is none at all."""
        row = source.row(mutant.id, round)
        if row is None:
            return False
        tree = key.rsplit(maxsplit=1)[-1]
        if tree != self._dependencies.tree:
            lines = self._lines_from(source, tree)
            data = lines.moved(row.data) if lines is not None else None
            if data is None:
                return False
            row = replace(row, data=data)
        self._add(source, tree, mutant, replace(row, key=now))
        return True

    def _add(self, source: JournalReader, tree: str, mutant: Mutant, row: Row) -> None:
        self.rows.append(row)
        some, all = (self._dependencies.tests(mutant, row.round, whole=whole) for whole in (False, True))
        if row.verdict == Verdict.SURVIVED and len(some) < len(all):
            self.unasked += not self._trees.says_same(source, tree)

    def _lines_from(self, source: JournalReader, tree: str) -> Lines | None:
        if tree not in self._lines:
            old = self._trees.reach(source, tree)
            new = self._dependencies.reach.project
            self._lines[tree] = Lines(old.project, new) if old is not None else None
        return self._lines[tree]
