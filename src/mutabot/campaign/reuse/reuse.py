"""Reuse: which outcomes of earlier campaigns still hold, and why the others are run again.

What is taken over names lines as they are now.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from mutabot.campaign.request import Progress, Request
from mutabot.errors import in_short
from mutabot.journal.journal import Journal, JournalReader
from mutabot.journal.records import Kept
from mutabot.model import Mutant, Verdict

from .keys import Dependencies, Parts, Tree, Was

Pair = tuple[str, int]
#: names that are given before it is said how many more there are
_SHOWN = 3


class Earlier:
    """The outcomes that a journal holds, and what they depended on.

    Args:
        now: what outcomes depend on now.
        journal: the journal.
    """

    def __init__(self, now: Dependencies, journal: JournalReader) -> None:
        self.kept = journal.found()
        self._now, self._journal = now, journal
        self._parts: dict[str, Parts | None] = {}
        self._trees: dict[str, Tree] = {}
        self._was: dict[str, Was] = {}

    def was(self, key: str) -> Was:
        """What an outcome with this key depended on."""
        if key not in self._was:
            self._was[key] = self._now.was(key, self._parts_of, self._tree)
        return self._was[key]

    def why(self, pair: Pair, mutant: Mutant, *, is_known: bool = True) -> str | None:
        """Why an outcome may come out otherwise now, in words; None if it cannot. There is one."""
        names = self._now.why(self.was(self.kept[pair].key), mutant, pair[1], is_known=is_known)
        return in_short(names) if names else None

    def row(self, pair: Pair, mutant: Mutant) -> Kept | None:
        """An outcome as it is now; None if it names a line that nobody can find, or is none at all."""
        row = self._journal.row(*pair)
        if row is None:
            return None
        was = self.was(row.key)
        data = was.tree.moved(row.data, self._now.tree)
        if data is None:
            return None
        return replace(row, data=data, key=self._now.renewed(row.key, was, mutant, row.round))

    def is_unasked(self, row: Kept, mutant: Mutant) -> bool:
        """Whether it is a survivor that some tests do not reach, and only these could notice what changed."""
        some, all = (self._now.tests(mutant, row.round, whole=whole) for whole in (False, True))
        if row.verdict != Verdict.SURVIVED or len(some) == len(all):
            return False
        return self.was(self.kept[row.mutant, row.round].key).tree.said != self._now.tree.said

    def _parts_of(self, digest: str) -> Parts | None:
        if digest not in self._parts:
            self._parts[digest] = self._journal.parts(digest)
        return self._parts[digest]

    def _tree(self, digest: str) -> Tree:
        if digest not in self._trees:
            parts = self._parts_of(digest) or {}
            self._trees[digest] = Tree(parts, lambda name, text: self._journal.text(text))
        return self._trees[digest]


#: why an outcome is not taken over although it holds
GONE = "a line that they name is gone"


@dataclass(slots=True)
class Reused:
    """What became of outcomes that earlier campaigns found.

    Attributes:
        done: mutants, by id, and rounds whose outcomes are taken over.
        why: of the others that there are outcomes of, why these do not hold.
        unsound: of which there are outcomes that say nothing.
        first: how many there are none of.
        before: what the others were that do not hold.
        unasked: how many that are taken over are survivors that some tests do not reach, while something has
            changed that only these could notice.
        sources: what the journals hold.
    """

    done: set[Pair] = field(default_factory=set)
    why: dict[Pair, str] = field(default_factory=dict)
    unsound: set[Pair] = field(default_factory=set)
    first: int = 0
    before: dict[Pair, Verdict] = field(default_factory=dict)
    unasked: int = 0
    sources: Sequence[Earlier] = ()


def reuse(
    journal: Journal,
    dependencies: Dependencies,
    mutants: Sequence[Mutant],
    rounds: int,
    progress: Progress,
    others: Sequence[JournalReader] = (),
) -> Reused:
    """Take over the outcomes that still hold, and say why the others do not.

    Args:
        others: journals of other campaigns of this project, to be looked into beside its own.
    """
    sources = [Earlier(dependencies, one) for one in (journal, *others)]
    found = Reused(sources=sources)
    if not any(one.kept for one in sources):
        found.first = rounds * len(mutants)
        return found
    pairs = [(mutant, round) for round in range(rounds) for mutant in mutants]
    taken = [_taken(found, mutant, round) for mutant, round in pairs]
    journal.add_parts(dependencies.new_parts())
    journal.take_over(row for row in taken if row is not None)
    progress.note(text_of(found))
    if found.unasked:
        progress.note(
            f"{found.unasked} of them are survivors that tests do not reach which may have changed: "
            "these are not asked again; `mutabot run --fresh` asks all"
        )
    return found


def _taken(found: Reused, mutant: Mutant, round: int) -> Kept | None:
    """One outcome from the first source in which it holds; else why it does not in the first that has it."""
    pair = (mutant.id, round)
    first: str | None = None
    for earlier in found.sources:
        outcome = earlier.kept.get(pair)
        if outcome is None:
            continue
        why = earlier.why(pair, mutant)
        if why is None and not outcome.is_sound:
            found.unsound.add(pair)
        elif why is None:
            row = earlier.row(pair, mutant)
            if row is not None:
                found.done.add(pair)
                found.unsound.discard(pair)
                found.unasked += earlier.is_unasked(row, mutant)
                return row
            first = first or GONE
        elif first is None:
            first = why
            found.before[pair] = outcome.verdict
    if first is not None:
        found.why[pair] = first
    elif pair not in found.unsound:
        found.first += 1
    return None


def note_outdated(journal: Journal, request: Request, dependencies: Dependencies) -> None:
    """Find out which mutants of earlier campaigns depend on something that has changed since."""
    known = [mutant for mutant, _ in journal.known()]
    if not known:
        return
    earlier = Earlier(dependencies, journal)

    def is_outdated(mutant: Mutant) -> bool:
        pairs = [(mutant.id, round) for round in range(request.rounds)]
        is_known = mutant.family in request.families
        return any(
            pair not in earlier.kept or earlier.why(pair, mutant, is_known=is_known) is not None
            for pair in pairs
        )

    journal.set_known([(mutant, is_outdated(mutant)) for mutant in known])


def text_of(found: Reused) -> str:
    """What was taken over, and why the rest was not, in words."""
    reused = len(found.done)
    planned = len(found.done) + len(found.why) + len(found.unsound - found.why.keys()) + found.first
    if reused == planned:
        return f"reused all {planned} outcomes: nothing that they depend on has changed"
    parts = [f"reused {reused} of {planned} outcomes"]
    parts += reasons_in_words(found.why.values())
    unsound = len(found.unsound - found.why.keys())
    if unsound:
        parts.append(f"{unsound} run again: they ended in an error or unstable")
    if found.first:
        is_all = not (reused or found.why or unsound)
        parts.append(f"{found.first} {'run for the first time' if is_all else 'not run before'}")
    return "; ".join(parts)


def reasons_in_words(why: Iterable[str]) -> list[str]:
    """How many are run again, by the reason."""
    counts = Counter(why)
    parts = [f"{count} run again: {reason}" for reason, count in counts.most_common(_SHOWN)]
    rest = sum(count for _, count in counts.most_common()[_SHOWN:])
    return [*parts, *([f"{rest} run again for other reasons"] if rest else [])]
