"""Presumed: outcomes whose own statement and tests have not changed, though something else that runs has.

Nobody knows that they would come out the same. They are taken over only where that was asked for, are marked,
and are never taken for known later.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace

from mutabot.campaign.pieces.lines import Lines
from mutabot.campaign.pieces.reach import Reach
from mutabot.campaign.pieces.statements import Statement, matched, statements
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import Kept, Row
from mutabot.model import Mutant

from .keys import REACHED, Dependencies, role_of
from .trees import Trees

Pair = tuple[str, int]


class Presumed:
    """What can be presumed of the outcomes that a journal holds."""

    def __init__(self, journal: JournalReader, kept: Mapping[Pair, Kept], dependencies: Dependencies) -> None:
        self._journal, self._kept, self._dependencies = journal, kept, dependencies
        self._trees = Trees(dependencies)
        self._lines: dict[str, Lines] = {}
        self._matched: dict[tuple[str, str, str], tuple[list[Statement], list[Statement]]] = {}
        self._others: dict[tuple[object, ...], bool] = {}
        trees = (one.key.split() for one in kept.values())
        self._all_trees = list(dict.fromkeys(words[3] for words in trees if len(words) > 3))

    def row(self, mutant: Mutant, round: int) -> tuple[Row, str] | None:
        """The outcome and the id under which it was found; None if nothing can be presumed."""
        for tree in self._all_trees:
            old = self._trees.reach(self._journal, tree)
            was = self._as_it_was(mutant, old, tree) if old is not None else None
            kept = self._kept.get((was, round)) if was is not None else None
            if old is None or was is None or kept is None or not kept.is_sound:
                continue
            if not kept.key.endswith(f" {tree}") or not self._is_alike(kept.key, mutant, round, old, tree):
                continue
            row = self._journal.row(was, round)
            if row is None:
                continue
            data = self._lines_from(tree, old).moved(json.dumps({**json.loads(row.data), "mutant": ""}))
            if data is not None:
                data = json.dumps({**json.loads(data), "mutant": mutant.id}, ensure_ascii=False)
                return replace(row, mutant=mutant.id, data=data, key="", presumed=True), was
        return None

    def _is_alike(self, key: str, mutant: Mutant, round: int, old: Reach, tree: str) -> bool:
        """Whether all is as it was but for other parts of the program."""
        was, now = key.split(), self._dependencies.keys(mutant, round)[0].split()
        before, after = self._journal.parts(was[1]), self._dependencies.parts[now[1]]
        if was[0] != now[0] or was[2] != now[2] or before is None:
            return False
        if {**before, REACHED: ""} != {**after, REACHED: ""}:
            return False
        tests = self._dependencies.judges(mutant, round)[0]
        known = (tree, now[1])
        if known not in self._others:
            is_other = self._is_no_program
            there = old.digest(old.only(self._dependencies.reached(mutant, tests, old), is_other))
            reach = self._dependencies.reach
            here = reach.digest(reach.only(self._dependencies.reached(mutant, tests), is_other))
            self._others[known] = there == here
        return self._others[known]

    @property
    def _is_no_program(self) -> Callable[[str], bool]:
        return lambda file: role_of(file, self._dependencies.request) != "program"

    def _as_it_was(self, mutant: Mutant, old: Reach, tree: str) -> str | None:
        """The id of a mutant in another version of the program; None if its statement was not there."""
        parts = [self._single_as_it_was(single, old, tree) for single in mutant.singles]
        return "+".join(part for part in parts if part) if all(parts) else None

    def _single_as_it_was(self, mutant: Mutant, old: Reach, tree: str) -> str | None:
        site = mutant.site
        file, function = site.span.file, site.span.function.partition(".<locals>")[0]
        key = (tree, file, function)
        if key not in self._matched:
            self._matched[key] = (
                _statements(old, file, function),
                _statements(self._dependencies.reach, file, function),
            )
        before, now = self._matched[key]
        here = [
            number
            for number, one in enumerate(now)
            if one.lines[0] <= site.span.line and site.span.end_line <= one.lines[1]
        ]
        was = matched(before, now).get(here[-1]) if here else None
        if was is None:
            return None
        calls = bool(mutant.operation)
        earlier = sum(one.counts(site.text, calls=calls) for one in before[:was])
        shift = earlier - sum(one.counts(site.text, calls=calls) for one in now[: here[-1]])
        return replace(mutant, site=replace(site, occurrence=site.occurrence + shift)).id

    def _lines_from(self, tree: str, old: Reach) -> Lines:
        if tree not in self._lines:
            self._lines[tree] = Lines(old.project, self._dependencies.reach.project, by_statement=True)
        return self._lines[tree]


def _statements(reach: Reach, file: str, function: str) -> list[Statement]:
    return [one for piece in reach.pieces_at(file, function) for one in statements(piece)]
