"""One journal of the journals of shards, as if one campaign had run, if they are of one plan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from mutabot.campaign.plan import renumbered
from mutabot.campaign.reuse.keys import changes
from mutabot.errors import MergeError
from mutabot.frozen import frozen
from mutabot.journal.files import HOME, JOURNAL
from mutabot.journal.journal import Journal
from mutabot.journal.lock import is_written, refuse_tracked
from mutabot.journal.reader import JournalReader
from mutabot.journal.recordings import Recordings
from mutabot.journal.records import (
    ALTERED,
    DRAWING,
    FACTS,
    FLAKY,
    REPEATS,
    SHARD,
    VERIFICATION,
    Flaky,
    ShardOf,
)
from mutabot.model import Mutant
from mutabot.model.codec import from_data, to_data

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


#: how a campaign ends that lacks something
_INCOMPLETE = "not all shards are there"


def merge(paths: Sequence[Path], target: Path, *, root: Path, room: int) -> list[str]:
    """Write one journal of the shards' journals and recordings. Returns what is missing, a line each.

    What was in ``target`` before is kept as by any new campaign.

    Args:
        paths: journals, or folders with one.
        target: where the journal is written.
        root: the project.
        room: bytes that recordings may take.

    Raises MergeError if these are not shards of one plan, JournalError for a file that cannot be used.
    """
    with ExitStack() as stack:
        parts = [_opened(stack, found_in(path)) for path in paths]
        if not parts:
            raise MergeError("there is nothing to merge: name the journals of the shards")
        parts.sort(key=lambda part: part.shard.number)
        refuse_strangers(parts)
        missing = list(_missing(parts))
        meta = {**_meta(parts), "root": str(root)}
        with Journal.create(target, meta=meta) as journal:
            journal.take_plan(parts[0].journal)
            for part in parts:
                journal.take_outcomes(part.journal)
            known = _known(journal, parts)
            journal.set_known(known)
            _merge_recordings(stack, parts, target, room, {one.id for one, _ in known})
            journal.finish(_INCOMPLETE if missing else "complete")
    return missing


def found_in(path: Path) -> Path:
    """The journal that is meant: a file, or that in a folder. Raises MergeError if there is none."""
    places = (path, path / JOURNAL, path / HOME / JOURNAL)
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        raise MergeError(f"there is no journal {path}" + (f", nor {JOURNAL} in it" if path.is_dir() else ""))
    return found


def _opened(stack: ExitStack, path: Path) -> Part:
    refuse_tracked(path)
    if is_written(path):
        raise MergeError(f"{path} is being written by a `mutabot run`: merge it when that has ended")
    return Part.of(path, stack.enter_context(JournalReader.open(path)))


def _missing(parts: Sequence[Part]) -> Iterator[str]:
    """What a whole campaign would have beyond these."""
    first = parts[0]
    of, rounds = first.shard.of, int(first.meta.get("rounds") or 1)
    there = {part.shard.number for part in parts}
    claimed = [number for part in parts for number in part.shard.mutants]
    free = len({one.number for one in first.mutants} - set(claimed))
    absent = [number for number in range(1, of + 1) if number not in there]
    if absent:
        names = ", ".join(map(str, absent))
        again = ", ".join(f"`mutabot run --shard {number}/{of}`" for number in absent[:3])
        more = " …" if len(absent) > 3 else ""
        yield (
            f"{'shard' if len(absent) == 1 else 'shards'} {names} of {of} missing, {free} of "
            f"{len(first.mutants)} mutants, {free * rounds} outcomes: run {again}{more} and merge again"
        )
    elif free:
        yield (
            f"{free} mutants are in no shard, since the baselines of the shards differ: `mutabot run` with "
            "the merged journal runs them alone"
        )
    for part in parts:
        if part.journal.set_aside:
            yield (
                f"{part.words} holds what mutabot has not written, or what is damaged "
                f"({part.journal.set_aside[0]}): run it again with "
                f"`mutabot run --shard {part.shard.number}/{of}`, and merge again"
            )
        ended = part.journal.finished or "killed"
        if ended != "complete":
            lacking = _lacking(part, rounds)
            yield (
                f"{part.words} is not complete ({ended}), {lacking}: run it again with "
                f"`mutabot run --shard {part.shard.number}/{of}` and its journal, and merge again"
            )


def _lacking(part: Part, rounds: int) -> str:
    """How many outcomes a shard lacks; of ladders nobody knows how many it takes."""
    own = set(part.shard.mutants)
    alone = {one.id for one in part.mutants if one.number in own and not one.ladder}
    done = sum(one.mutant in alone for one in part.journal.outcomes())
    ladders = any(one.number in own and one.ladder for one in part.mutants)
    return f"{len(alone) * rounds - done} outcomes are missing{', and some of ladders' if ladders else ''}"


def _meta(parts: Sequence[Part]) -> dict[str, Any]:
    """What the campaign says about itself: that of the first shard, and sums of what was counted."""
    metas = [part.meta for part in parts]
    found = {key: value for key, value in metas[0].items() if key != SHARD}
    found["shards"] = parts[0].shard.of
    for key, together in (("started", min), ("seconds", max)):
        values = [meta[key] for meta in metas if meta.get(key) is not None]
        if values:
            found[key] = together(values)
    for key in (ALTERED, FLAKY, VERIFICATION, REPEATS):
        said = [from_data(FACTS[key], meta[key]) for meta in metas if key in meta]
        if said:
            found[key] = to_data(_flaky(said)) if key == FLAKY else _summed([to_data(one) for one in said])
    return found


def _flaky(said: Sequence[Flaky]) -> Flaky:
    tests = dict.fromkeys(test for one in said for test in one.tests)
    return Flaky(tuple(tests), max(one.known for one in said))


def _summed(said: Sequence[Any]) -> Any:
    """Data of one form: numbers are added, lists put one behind the other."""
    first = said[0]
    if isinstance(first, dict):
        return {key: _summed([one[key] for one in said]) for key in first}
    return [item for one in said for item in one] if isinstance(first, list) else sum(said)


def _known(journal: Journal, parts: Sequence[Part]) -> list[tuple[Any, bool]]:
    """Mutants of earlier campaigns beside the plan: what shards say of them counts."""
    planned = parts[0].mutants
    ids = {one.id for one in planned}
    found = {one.id: (one, outdated) for one, outdated in journal.known()}
    for part in parts:
        found.update((one.id, (one, outdated)) for one, outdated in part.journal.known())
    left = [(one, outdated) for name, (one, outdated) in found.items() if name not in ids]
    is_outdated = {one.id: outdated for one, outdated in left}
    return [(one, is_outdated[one.id]) for one in renumbered([one for one, _ in left], planned)]


def _merge_recordings(
    stack: ExitStack, parts: Sequence[Part], target: Path, room: int, known: set[str]
) -> None:
    found = [Recordings.to_read(part.path, copied=_is_same(part.path, target)) for part in parts]
    opened = [stack.enter_context(one) for one in found if one is not None]
    if opened:
        mutants = known | {one.id for one in parts[0].mutants}
        with Recordings.to_write(target, room) as recordings:
            recordings.take(opened, mutants)


def _is_same(path: Path, target: Path) -> bool:
    """Whether a shard lies where the whole is to lie."""
    return target.exists() and path.samefile(target)
