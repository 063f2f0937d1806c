"""Whether shards are of one plan, and what differs if they are not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mutabot.border.codec import from_data
from mutabot.campaign.reuse.keys import changes
from mutabot.errors import MergeError
from mutabot.frozen import frozen
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import DRAWING, SHARD, ShardOf
from mutabot.model import Mutant

#: facts of a campaign that decide which outcomes it has, and their names on the command line
_FACTS = {
    "seed": "the seed",
    "rounds": "the number of rounds",
    "families": "the families",
    DRAWING: "the sample",
}
#: facts that are told; the rest is counted
_SHOWN = 5


@frozen
class Part:
    """The journal of a shard, opened.

    Attributes:
        path: as the user named it.
        journal: to be read.
        meta: what its campaign said about itself.
        shard: which part it is.
        mutants: the whole plan.
    """

    path: Path
    journal: JournalReader
    meta: Mapping[str, Any]
    shard: ShardOf
    mutants: tuple[Mutant, ...]

    @classmethod
    def of(cls, path: Path, journal: JournalReader) -> Part:
        """What is in the journal. Raises MergeError if that is no shard."""
        meta = journal.meta()
        if SHARD not in meta:
            raise MergeError(
                f"{path} holds a whole campaign, not a shard: shards come from `mutabot run --shard 1/8`"
            )
        return cls(path, journal, meta, from_data(ShardOf, meta[SHARD]), tuple(journal.mutants()))

    @property
    def words(self) -> str:
        """``shard 2 of 8 (b.sqlite)``."""
        return f"{self.shard.words} ({self.path})"


def refuse_strangers(parts: Sequence[Part]) -> None:
    """Raise MergeError if these are not different shards of one plan, and say what differs."""
    first, *others = parts
    by_number: dict[int, Part] = {}
    for part in parts:
        other = by_number.setdefault(part.shard.number, part)
        if other is not part:
            raise MergeError(f"{part.shard.words} is there twice: {other.path} and {part.path}")
        if part.shard.depends is None:
            raise MergeError(
                f"{part.words} ended in its baseline, or files changed meanwhile, so that nobody knows what "
                f"it was about: run it again with --shard {part.shard.number}/{part.shard.of} or leave it out"
            )
    for part in others:
        differing = list(_differing(first, part))
        if differing:
            more = f"; and {len(differing) - _SHOWN} more" if len(differing) > _SHOWN else ""
            raise MergeError(
                f"{part.words} and {first.words} are not of one plan: {'; '.join(differing[:_SHOWN])}{more}. "
                "Run all shards of one commit with the same options, packages and kind of machine"
            )


def _differing(old: Part, new: Part) -> Iterator[str]:
    if old.shard.of != new.shard.of:
        yield f"one is of {new.shard.of} shards, the other of {old.shard.of}"
    for key, name in _FACTS.items():
        before, now = old.meta.get(key), new.meta.get(key)
        if before != now:
            yield f"{name} is {_short(now)} in the one, {_short(before)} in the other"
    told = changes(_without_facts(old), _without_facts(new))
    yield from told
    if not told:  # else they differ for that reason
        yield from _other_mutants(old, new)


def _without_facts(part: Part) -> Mapping[str, str]:
    return {name: value for name, value in (part.shard.depends or {}).items() if name not in _FACTS}


def _other_mutants(old: Part, new: Part) -> Iterator[str]:
    before, now = ({one.id: one.number for one in part.mutants} for part in (old, new))
    for some, others, where in ((now, before, new), (before, now, old)):
        extra = [name for name in some if name not in others]
        if extra:
            yield f"{len(extra)} mutants are planned in {where.path} alone, such as {extra[0]}"
    if before.keys() == now.keys() and before != now:
        yield "the mutants have other numbers"


def _short(value: Any) -> str:
    text = ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return text if len(text) <= 60 else f"{text[:60]}…"
