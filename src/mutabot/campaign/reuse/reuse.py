"""Reuse: which outcomes of earlier campaigns still hold, and why the others are run again."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from mutabot.campaign.request import Progress
from mutabot.journal.journal import Journal
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import Kept
from mutabot.model import Mutant, Verdict

from .keys import Dependencies
from .reasons import Reasons
from .taken_over import TakenOver

#: reasons that a note gives before it says how many more there are
_SHOWN = 3
#: why an outcome is not taken over although it holds
GONE = "a line that they name is gone"
Pair = tuple[str, int]


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
