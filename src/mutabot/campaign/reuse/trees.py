"""Trees: the Python files of earlier campaigns, as their journals hold them."""

from __future__ import annotations

from mutabot.campaign.pieces.reach import Reach
from mutabot.journal.reader import JournalReader

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

    def _read(self, journal: JournalReader, tree: str) -> Reach | None:
        files = journal.parts(tree)
        if files is None:
            return None
        texts = {name: journal.text(digest) for name, digest in files.items()}
        known = {name: text for name, text in texts.items() if text is not None}
        return self._dependencies.reach_of(files, known) if len(known) == len(files) else None
