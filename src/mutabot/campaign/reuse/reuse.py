"""Reuse: which outcomes of earlier campaigns still hold, and why the others are run again."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from mutabot.campaign.request import Progress
from mutabot.journal.journal import Journal
from mutabot.model import Mutant

from .keys import Dependencies, changes

#: names and reasons that a note gives before it says how many more there are
_SHOWN = 3


def reuse(
    journal: Journal, dependencies: Dependencies, mutants: Sequence[Mutant], rounds: int, progress: Progress
) -> set[tuple[str, int]]:
    """Take over the outcomes that still hold, and say why the others do not; their ids and rounds."""
    kept = journal.kept()
    if not kept:
        return set()
    why = _Reasons(journal, dependencies)
    reasons: Counter[str] = Counter()
    done = set()
    for round in range(rounds):
        for mutant in mutants:
            outcome = kept.get((mutant.id, round))
            keys = dependencies.keys(mutant, round)
            if outcome is None:
                reasons[""] += 1
            elif outcome.key not in keys:
                reasons[why.of(outcome.key, keys[0])] += 1
            elif not outcome.is_sound:
                reasons["they ended in an error or unstable"] += 1
            else:
                done.add((mutant.id, round))
    journal.add_parts(dependencies.new_parts())
    journal.reuse(done)
    progress.note(_text(len(done), rounds * len(mutants), reasons))
    return done


class _Reasons:
    """Why a key is not equal to another."""

    def __init__(self, journal: Journal, dependencies: Dependencies) -> None:
        self._journal, self._dependencies = journal, dependencies
        self._known: dict[tuple[str, str], list[str]] = {}

    def of(self, old: str, new: str) -> str:
        """In words."""
        names: list[str] = []
        *old_parts, old_own = old.split()
        *new_parts, new_own = new.split()
        for pair in zip(old_parts, new_parts, strict=True):
            if pair[0] != pair[1]:
                names += self._changes(*pair)
        if old_own != new_own:
            names.append("the calls return something else")
        more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
        return ", ".join(names[:_SHOWN]) + more

    def _changes(self, old: str, new: str) -> list[str]:
        if (old, new) not in self._known:
            parts = self._journal.parts(old)
            found = changes(parts, self._dependencies.parts[new]) if parts is not None else []
            self._known[old, new] = found or ["what they depend on changed"]
        return self._known[old, new]


def _text(reused: int, planned: int, reasons: Counter[str]) -> str:
    if reused == planned:
        return f"reused all {planned} outcomes: nothing that they depend on has changed"
    first = reasons.pop("", 0)
    parts = [f"reused {reused} of {planned} outcomes"]
    parts += [f"{count} run again: {why}" for why, count in reasons.most_common(_SHOWN)]
    rest = sum(count for _, count in reasons.most_common()[_SHOWN:])
    if rest:
        parts.append(f"{rest} run again for other reasons")
    if first:
        parts.append(f"{first} not run before" if reused or reasons else f"{first} run for the first time")
    return "; ".join(parts)
