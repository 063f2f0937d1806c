"""Reuse: which outcomes of earlier campaigns still hold, and why the others are run again.

What is taken over names lines as they are now.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from mutabot.campaign.pieces.project import Lines
from mutabot.campaign.pieces.reach import Reach
from mutabot.campaign.request import Progress
from mutabot.journal.journal import Journal
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import Kept, Row
from mutabot.model import Mutant, Verdict

from .keys import ASIDE, REACHED, REACHING, SUITE, Dependencies, Parts, changes


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


#: names that are given before it is said how many more there are
_SHOWN = 3


class Reasons:
    """Why keys of a journal are not what they would be now."""

    def __init__(self, journal: JournalReader, dependencies: Dependencies) -> None:
        self._journal, self._dependencies = journal, dependencies
        self._trees = Trees(dependencies)
        self._known: dict[tuple[str, ...], list[str]] = {}
        self._sites: dict[tuple[str, ...], bool] = {}

    def of(self, old: str, mutant: Mutant, round: int) -> str:
        """In words."""
        new = self._dependencies.key(mutant, round, whole=self.is_whole(old))
        names = self._changes(old, new, mutant, round)
        return shortened(names)

    def is_whole(self, old: str) -> bool:
        """Whether an outcome depends on all tests."""
        return SUITE in self._parts(old.split()[1])

    def is_site_changed(self, old: str, mutant: Mutant) -> bool:
        """Whether what stands where a mutant acts says something else, or nobody knows."""
        key = (old.rsplit(maxsplit=1)[-1], mutant.site.id)
        if key not in self._sites:
            then = self._trees.reach(self._journal, key[0])
            now = self._dependencies.reach
            where = mutant.site.span.file, mutant.site.span.function
            self._sites[key] = then is None or then.standing(*where) != now.standing(*where)
        return self._sites[key]

    def _changes(self, old: str, new: str, mutant: Mutant, round: int) -> list[str]:
        before, now = old.split(), new.split()
        if len(before) != len(now):
            return ["they are of an older version of mutabot"]
        names: list[str] = []
        if before[1] != now[1]:
            names += self._at_place(before, now, mutant, round)
        if before[0] != now[0]:
            names += self._of_parts(before[0], now[0])
        if before[2] != now[2] and not names:
            names.append("the calls return something else")
        return names or ["what they depend on changed"]

    def _of_parts(self, old: str, new: str) -> list[str]:
        key = old, new
        if key not in self._known:
            self._known[key] = changes(self._parts(old), self._dependencies.parts[new])
        return self._known[key]

    def _at_place(self, before: list[str], now: list[str], mutant: Mutant, round: int) -> list[str]:
        key = before[1], now[1], before[3]
        if key not in self._known:
            old, new = self._parts(before[1]), self._dependencies.parts[now[1]]
            tests = self._dependencies.tests(mutant, round, whole=SUITE in new)
            names = self._pieces(before[3], mutant, tests) if old.get(REACHED) != new[REACHED] else []
            unnamed = {REACHED, REACHING, SUITE, ASIDE} if names else set()
            others = changes(
                {name: value for name, value in old.items() if name not in unnamed},
                {name: value for name, value in new.items() if name not in unnamed},
            )
            self._known[key] = [*names, *others]
        return self._known[key]

    def _pieces(self, tree: str, mutant: Mutant, tests: tuple[str, ...]) -> list[str]:
        """The pieces that say something else."""
        old = self._trees.reach(self._journal, tree)
        if old is None:
            return []
        now = self._dependencies.reach.says(self._dependencies.reached(mutant, tests))
        before = old.says(self._dependencies.reached(mutant, tests, old))
        return different(before, now)

    def _parts(self, digest: str) -> Parts:
        return self._journal.parts(digest) or {}


def different(before: dict[str, tuple[str, ...]], now: dict[str, tuple[str, ...]]) -> list[str]:
    """Which pieces say something else, in words; what is new last, for it is there as others mention it."""
    found = [f"{name} changed" for name in now if name in before and before[name] != now[name]]
    found += [f"{name} is gone" for name in before if name not in now]
    return sorted(found) + sorted(f"{name} is new" for name in now if name not in before)


def apart(then: Dependencies, now: Dependencies, mutant: Mutant, round: int) -> str:
    """What differs between two states of the files, as far as a mutant depends on it, in words."""
    tests = now.tests(mutant, round, whole=False)
    names = different(
        then.reach.says(then.reached(mutant, tests)), now.reach.says(now.reached(mutant, tests))
    )
    before, after = (one.key(mutant, round).split() for one in (then, now))
    for position in (1, 0):
        old, new = then.parts[before[position]], now.parts[after[position]]
        names += changes(
            {name: value for name, value in old.items() if name != REACHED},
            {name: value for name, value in new.items() if name != REACHED},
        )
    return shortened(names)


def shortened(names: list[str]) -> str:
    """The first few of them."""
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more


#: why an outcome is not taken over although it holds
GONE = "a line that they name is gone"


@dataclass(slots=True)
class Reused:
    """What became of outcomes that earlier campaigns found.

    Attributes:
        done: mutants, by id, and rounds whose outcomes are taken over.
        why: of the others that there are outcomes of, why these do not hold.
        unsound: of which there are outcomes that say nothing.
        first: of which there are none.
        before: what the others were that do not hold.
        sites: mutants at which something else stands than when they were run.
        whole: of those whose outcomes do not hold, the ones that depended on all tests.
    """

    done: set[Pair] = field(default_factory=set)
    why: dict[Pair, str] = field(default_factory=dict)
    unsound: set[Pair] = field(default_factory=set)
    first: list[Pair] = field(default_factory=list)
    before: dict[Pair, Verdict] = field(default_factory=dict)
    sites: set[str] = field(default_factory=set)
    whole: set[Pair] = field(default_factory=set)


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
    sources = [(one, one.found()) for one in (journal, *others)]
    found = Reused()
    if not any(kept for _, kept in sources):
        found.first = [(mutant.id, round) for round in range(rounds) for mutant in mutants]
        return found
    reasons = [Reasons(one, dependencies) for one in (journal, *others)]
    taken = TakenOver(dependencies)
    for round in range(rounds):
        for mutant in mutants:
            _take(found, taken, sources, reasons, dependencies, mutant, round)
    journal.add_parts(dependencies.new_parts())
    journal.take_over(taken.rows)
    progress.note(text_of(found))
    if taken.unasked:
        progress.note(
            f"{taken.unasked} of them are survivors that tests do not reach which may have changed: "
            "these are not asked again; `mutabot run --fresh` asks all"
        )
    return found


def _take(
    found: Reused,
    taken: TakenOver,
    sources: Sequence[tuple[JournalReader, Mapping[Pair, Kept]]],
    reasons: Sequence[Reasons],
    dependencies: Dependencies,
    mutant: Mutant,
    round: int,
) -> None:
    """One outcome from the first source in which it holds; else why it does not in the first that has it."""
    pair = (mutant.id, round)
    why: str | None = None
    for (source, kept), explained in zip(sources, reasons, strict=True):
        outcome = kept.get(pair)
        now = dependencies.holding(outcome.key, mutant, round) if outcome is not None else None
        if outcome is not None and now is not None and not outcome.is_sound:
            found.unsound.add(pair)
        elif outcome is not None and now is not None:
            if taken.take(source, mutant, round, outcome.key, now):
                found.done.add(pair)
            why = why or GONE
        elif outcome is not None and why is None:
            why = explained.of(outcome.key, mutant, round)
            found.before[pair] = outcome.verdict
            if explained.is_whole(outcome.key):
                found.whole.add(pair)
            if explained.is_site_changed(outcome.key, mutant):
                found.sites.add(mutant.id)
        if pair in found.done:
            found.unsound.discard(pair)
            return
    if why is not None:
        found.why[pair] = why
    elif pair not in found.unsound:
        found.first.append(pair)


def text_of(found: Reused) -> str:
    """What was taken over, and why the rest was not, in words."""
    reused = len(found.done)
    planned = len(found.done) + len(found.why) + len(found.unsound - found.why.keys()) + len(found.first)
    if reused == planned:
        return f"reused all {planned} outcomes: nothing that they depend on has changed"
    parts = [f"reused {reused} of {planned} outcomes"]
    parts += reasons_in_words(found.why.values())
    unsound = len(found.unsound - found.why.keys())
    if unsound:
        parts.append(f"{unsound} run again: they ended in an error or unstable")
    first = len(found.first)
    if first:
        is_all = not (reused or found.why or unsound)
        parts.append(f"{first} run for the first time" if is_all else f"{first} not run before")
    return "; ".join(parts)


def reasons_in_words(why: Iterable[str]) -> list[str]:
    """How many are run again, by the reason."""
    counts = Counter(why)
    parts = [f"{count} run again: {reason}" for reason, count in counts.most_common(_SHOWN)]
    rest = sum(count for _, count in counts.most_common()[_SHOWN:])
    return [*parts, *([f"{rest} run again for other reasons"] if rest else [])]
