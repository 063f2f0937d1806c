"""Taking outcomes over: with the lines that they name as they are now, and from files as they were."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace

from mutabot.campaign.pieces.lines import Lines
from mutabot.campaign.pieces.moved import renaming_between
from mutabot.campaign.pieces.reach import Reach
from mutabot.campaign.pieces.renaming import Renaming
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import Kept, Row
from mutabot.model import Mutant, Verdict

from .keys import SUITE, Dependencies


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


def as_called(mutant: Mutant, renaming: Renaming) -> Mutant:
    """A mutant as it was called before."""
    span = mutant.site.span
    function, local, inner = span.function.partition(".<locals>")
    file, _, name = renaming.target(f"{span.file}:{function}").partition(":")
    span = replace(span, file=file, function=f"{name}{local}{inner}")
    return replace(mutant, site=replace(mutant.site, span=span, text=renaming.word(mutant.site.text)))


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
        self._seen: dict[int, list[str]] = {}

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

    def take_renamed(
        self, source: JournalReader, kept: Mapping[Pair, Kept], mutant: Mutant, round: int
    ) -> bool:
        """Take one over that was found where things had other names; returns False if there is none."""
        for tree in self._trees_in(kept):
            renaming = self._trees.renaming(source, tree)
            if not renaming:
                continue
            was = as_called(mutant, renaming).id
            outcome = kept.get((was, round))
            if outcome is None or not outcome.key.endswith(f" {tree}") or not outcome.is_sound:
                continue
            if not self._dependencies.holds_renamed(outcome.key, mutant, round, renaming, source.parts):
                continue
            row = source.row(was, round)
            data = self._renamed(source, tree, row, mutant.id, renaming) if row is not None else None
            if row is not None and data is not None:
                whole = SUITE in (source.parts(row.key.split()[1]) or {})
                key = self._dependencies.key(mutant, round, whole=whole)
                self._add(source, tree, mutant, replace(row, mutant=mutant.id, data=data, key=key))
                return True
        return False

    def _renamed(
        self, source: JournalReader, tree: str, row: Row, mutant: str, renaming: Renaming
    ) -> str | None:
        """The data of an outcome with what it names as that is called now; None if it tells of more."""
        data = {**json.loads(row.data), "mutant": ""}
        lines = self._lines_from(source, tree)
        moved = lines.moved(json.dumps(data, ensure_ascii=False)) if lines is not None else None
        if moved is None or renaming.tells_of(moved):
            return None
        return json.dumps({**json.loads(moved), "mutant": mutant}, ensure_ascii=False)

    def _trees_in(self, kept: Mapping[Pair, Kept]) -> list[str]:
        if id(kept) not in self._seen:
            words = (one.key.split() for one in kept.values())
            self._seen[id(kept)] = list(dict.fromkeys(one[3] for one in words if len(one) > 3))
        return self._seen[id(kept)]

    def _lines_from(self, source: JournalReader, tree: str) -> Lines | None:
        if tree not in self._lines:
            old = self._trees.reach(source, tree)
            new = self._dependencies.reach.project
            renaming = self._trees.renaming(source, tree)
            self._lines[tree] = Lines(old.project, new, renaming) if old is not None else None
        return self._lines[tree]
