"""Reasons: why an outcome of an earlier campaign does not hold any more, in words."""

from __future__ import annotations

from mutabot.journal.reader import JournalReader
from mutabot.model import Mutant

from .keys import ASIDE, REACHED, REACHING, SUITE, Dependencies, Parts, changes
from .taken_over import Trees

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
