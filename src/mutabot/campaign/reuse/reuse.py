"""Reuse: which outcomes of earlier campaigns still hold, and why the others are run again.

What is taken over names lines as they are now.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from mutabot.campaign.pieces.project import Lines
from mutabot.campaign.pieces.reach import Reach
from mutabot.campaign.request import Progress
from mutabot.journal.journal import Journal
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import Kept, Row
from mutabot.model import Mutant, Verdict

from .keys import ASIDE, REACHED, REACHING, SUITE, Dependencies, Parts, changes

Pair = tuple[str, int]
#: names that are given before it is said how many more there are
_SHOWN = 3


class Earlier:
    """What outcomes depended on when they were found: what keys of a journal, or of a revision, stand for.

    Args:
        now: what they depend on now.
        parts: what a digest in a key stands for; None if nobody knows that any more.
        text: what stood in a file with this digest, likewise.
        reaches: what tests could run, by the digest of all files, as far as that is known.
    """

    def __init__(
        self,
        now: Dependencies,
        parts: Callable[[str], Parts | None],
        text: Callable[[str], bytes | None] = lambda digest: None,
        reaches: Mapping[str, Reach] | None = None,
    ) -> None:
        self._now, self._parts, self._text = now, parts, text
        self._reaches: dict[str, Reach | None] = {**(reaches or {}), now.tree: now.reach}
        self._lines: dict[str, Lines | None] = {}
        self._known: dict[tuple[str, ...], list[str]] = {}
        self._sites: dict[tuple[str, ...], bool] = {}

    def _reach(self, tree: str) -> Reach | None:
        """What tests could run, by the digest of the files; None if these are not all known any more."""
        if tree not in self._reaches:
            files = self._parts(tree)
            texts = {name: self._text(digest) for name, digest in (files or {}).items()}
            known = {name: text for name, text in texts.items() if text is not None}
            is_known = files is not None and len(known) == len(files)
            self._reaches[tree] = self._now.reach_of(files or {}, known) if is_known else None
        return self._reaches[tree]

    def row(self, row: Row | None, key: str, now: str) -> Row | None:
        """An outcome as it is now; None if it names a line that nobody can find, or is none at all."""
        tree = _tree(key)
        if row is None or tree == self._now.tree:
            return row and replace(row, key=now)
        if tree not in self._lines:
            old = self._reach(tree)
            self._lines[tree] = Lines(old.project, self._now.reach.project) if old is not None else None
        lines = self._lines[tree]
        data = lines.moved(row.data) if lines is not None else None
        return replace(row, data=data, key=now) if data is not None else None

    def is_unasked(self, row: Row, key: str, mutant: Mutant) -> bool:
        """Whether it is a survivor that some tests do not reach, and only these could notice what changed."""
        some, all = (self._now.tests(mutant, row.round, whole=whole) for whole in (False, True))
        if row.verdict != Verdict.SURVIVED or len(some) == len(all):
            return False
        old = self._reach(_tree(key))
        return old is None or old.whole != self._now.reach.whole

    def why(self, old: str, mutant: Mutant, round: int) -> str:
        """Why a key is not what it would be now, in words."""
        new = self._now.key(mutant, round, whole=self.is_whole(old))
        before, now = old.split(), new.split()
        if len(before) != len(now):
            return "they are of an older version of mutabot"
        names: list[str] = []
        if before[1] != now[1]:
            names += self._at_place(before, now, mutant, round)
        if before[0] != now[0]:
            names += self._of_parts(before[0], now[0])
        if before[2] != now[2] and not names:
            names.append("the calls return something else")
        more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
        return ", ".join(names[:_SHOWN]) + more or "what they depend on changed"

    def is_whole(self, old: str) -> bool:
        """Whether an outcome depends on all tests."""
        return SUITE in (self._parts(old.split()[1]) or {})

    def is_site_changed(self, old: str, mutant: Mutant) -> bool:
        """Whether what stands where a mutant acts says something else, or nobody knows."""
        key = (_tree(old), mutant.site.id)
        if key not in self._sites:
            then, now = self._reach(key[0]), self._now.reach
            where = mutant.site.span.file, mutant.site.span.function
            self._sites[key] = then is None or then.standing(*where) != now.standing(*where)
        return self._sites[key]

    def _of_parts(self, old: str, new: str) -> list[str]:
        key = old, new
        if key not in self._known:
            self._known[key] = changes(self._parts(old) or {}, self._now.parts[new])
        return self._known[key]

    def _at_place(self, before: list[str], now: list[str], mutant: Mutant, round: int) -> list[str]:
        key = before[1], now[1], before[3]
        if key not in self._known:
            old, new = self._parts(before[1]) or {}, self._now.parts[now[1]]
            tests = self._now.tests(mutant, round, whole=SUITE in new)
            names = self._pieces(before[3], mutant, tests) if old.get(REACHED) != new[REACHED] else []
            unnamed = {REACHED, REACHING, SUITE, ASIDE} if names else set()
            others = changes(
                {name: value for name, value in old.items() if name not in unnamed},
                {name: value for name, value in new.items() if name not in unnamed},
            )
            self._known[key] = [*names, *others]
        return self._known[key]

    def _pieces(self, tree: str, mutant: Mutant, tests: tuple[str, ...]) -> list[str]:
        """The pieces that say something else; what is new last, for it is there as others mention it."""
        old = self._reach(tree)
        if old is None:
            return []
        now = self._now.reach.says(self._now.reached(mutant, tests))
        before = old.says(self._now.reached(mutant, tests, old))
        found = [f"{name} changed" for name in now if name in before and before[name] != now[name]]
        found += [f"{name} is gone" for name in before if name not in now]
        return sorted(found) + sorted(f"{name} is new" for name in now if name not in before)


def _tree(key: str) -> str:
    return key.rsplit(maxsplit=1)[-1]


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
        unasked: how many that are taken over are survivors that some tests do not reach, while something has
            changed that only these could notice.
    """

    done: set[Pair] = field(default_factory=set)
    why: dict[Pair, str] = field(default_factory=dict)
    unsound: set[Pair] = field(default_factory=set)
    first: list[Pair] = field(default_factory=list)
    before: dict[Pair, Verdict] = field(default_factory=dict)
    sites: set[str] = field(default_factory=set)
    whole: set[Pair] = field(default_factory=set)
    unasked: int = 0


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
    sources = [(one, one.found(), Earlier(dependencies, one.parts, one.text)) for one in (journal, *others)]
    found = Reused()
    if not any(kept for _, kept, _ in sources):
        found.first = [(mutant.id, round) for round in range(rounds) for mutant in mutants]
        return found
    pairs = [(mutant, round) for round in range(rounds) for mutant in mutants]
    taken = [_taken(found, sources, dependencies, mutant, round) for mutant, round in pairs]
    journal.add_parts(dependencies.new_parts())
    journal.take_over(row for row in taken if row is not None)
    progress.note(text_of(found))
    if found.unasked:
        progress.note(
            f"{found.unasked} of them are survivors that tests do not reach which may have changed: "
            "these are not asked again; `mutabot run --fresh` asks all"
        )
    return found


def _taken(
    found: Reused,
    sources: Sequence[tuple[JournalReader, Mapping[Pair, Kept], Earlier]],
    dependencies: Dependencies,
    mutant: Mutant,
    round: int,
) -> Row | None:
    """One outcome from the first source in which it holds; else why it does not in the first that has it."""
    pair = (mutant.id, round)
    why: str | None = None
    for source, kept, earlier in sources:
        outcome = kept.get(pair)
        if outcome is None:
            continue
        now = dependencies.holding(outcome.key, mutant, round)
        if now is not None and not outcome.is_sound:
            found.unsound.add(pair)
        elif now is not None:
            row = earlier.row(source.row(*pair), outcome.key, now)
            if row is not None:
                found.done.add(pair)
                found.unsound.discard(pair)
                found.unasked += earlier.is_unasked(row, outcome.key, mutant)
                return row
            why = why or GONE
        elif why is None:
            why = earlier.why(outcome.key, mutant, round)
            found.before[pair] = outcome.verdict
            if earlier.is_whole(outcome.key):
                found.whole.add(pair)
            if earlier.is_site_changed(outcome.key, mutant):
                found.sites.add(mutant.id)
    if why is not None:
        found.why[pair] = why
    elif pair not in found.unsound:
        found.first.append(pair)
    return None


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
