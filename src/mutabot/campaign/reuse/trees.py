"""Trees: the Python files of earlier campaigns, as their journals hold them."""

from __future__ import annotations

from dataclasses import replace

from mutabot.campaign.pieces.moved import renaming_between
from mutabot.campaign.pieces.reach import Reach
from mutabot.campaign.pieces.renaming import Renaming
from mutabot.journal.reader import JournalReader
from mutabot.model import Mutant

from .keys import Dependencies


class Trees:
    """What tests could run in earlier states of the files."""

    def __init__(self, dependencies: Dependencies) -> None:
        self._dependencies = dependencies
        self._known: dict[str, Reach | None] = {}
        self._renamings: dict[str, Renaming] = {}

    def reach(self, journal: JournalReader, tree: str) -> Reach | None:
        """By the digest of the files; None if the journal does not hold them all any more."""
        if tree not in self._known:
            self._known[tree] = self._read(journal, tree)
        return self._known[tree]

    def renaming(self, journal: JournalReader, tree: str) -> Renaming:
        """How things of now were called then; empty if nothing was, or if that is not known."""
        if tree not in self._renamings:
            old = self.reach(journal, tree) if tree != self._dependencies.tree else None
            now = self._dependencies.reach.project
            self._renamings[tree] = renaming_between(old.project, now) if old is not None else Renaming()
        return self._renamings[tree]

    def _read(self, journal: JournalReader, tree: str) -> Reach | None:
        files = journal.parts(tree)
        if files is None:
            return None
        texts = {name: journal.text(digest) for name, digest in files.items()}
        known = {name: text for name, text in texts.items() if text is not None}
        return self._dependencies.reach_of(files, known) if len(known) == len(files) else None


def as_called(mutant: Mutant, renaming: Renaming) -> Mutant:
    """A mutant as it was called before."""
    span = mutant.site.span
    function, local, inner = span.function.partition(".<locals>")
    file, _, name = renaming.target(f"{span.file}:{function}").partition(":")
    span = replace(span, file=file, function=f"{name}{local}{inner}")
    return replace(mutant, site=replace(mutant.site, span=span, text=renaming.word(mutant.site.text)))
