"""Shards: divide a plan, and merge the journals as if one campaign had run.

Parts are disjoint, together whole, balanced, and stable under small changes.

Every shard finds out by itself, so all that counts is the same on every machine: ids, and costs that no clock
has measured. Each mutant, or all magnitudes of a ladder, goes to the shard that its id likes best (rendezvous
hashing), if there is room (bounded loads).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mutabot.campaign.baseline.baseline import Baseline, cost
from mutabot.campaign.plan import Plan, renumbered
from mutabot.campaign.reuse.keys import Dependencies, changed_parts
from mutabot.errors import MergeError
from mutabot.frozen import frozen
from mutabot.journal import records
from mutabot.journal.files import HOME, JOURNAL, is_written, refuse_tracked
from mutabot.journal.journal import Journal
from mutabot.journal.reader import JournalReader
from mutabot.journal.recordings import Recordings
from mutabot.model import Mutant
from mutabot.model.codec import to_data

if TYPE_CHECKING:
    from mutabot.campaign.request import Request
    from mutabot.config.options import Shard

#: how much more than its part a shard takes before a piece goes elsewhere
_SLACK = 1.05


def assign(costs: Mapping[str, float], shards: int) -> dict[str, int]:
    """Return the 0-based shard of each item, by its id; costs are more than 0, in any unit."""
    room = _SLACK * math.fsum(costs.values()) / shards
    loads = [0.0] * shards
    found: dict[str, int] = {}
    # Large ones first, as they fit the worst; by classes, so that a change of cost seldom changes the order.
    for name, price in sorted(
        costs.items(), key=lambda name_and_cost: (-math.frexp(name_and_cost[1])[1], _hash(name_and_cost[0]))
    ):
        liked = sorted(range(shards), key=lambda shard: _hash(f"{name} {shard}"))
        chosen = next((number for number in liked if loads[number] + price <= room), None)
        found[name] = min(liked, key=lambda number: loads[number]) if chosen is None else chosen
        loads[found[name]] += price
    return found


def _hash(text: str) -> int:
    return int.from_bytes(blake2b(text.encode(), digest_size=8).digest(), "big")


#: what a mutant costs beside its tests, and what an operation costs, in simulated seconds: the clock on the
#: wall shows something else on each machine; and how many magnitudes a ladder runs, about
_START, _OPERATION, _SEARCH = 0.1, 0.01, 4


def part_of(plan: Plan, shard: Shard | None, baseline: Baseline) -> Plan:
    """Return the part of a plan that a shard runs; all of it without a shard."""
    if shard is None:
        return plan
    items: dict[str, list[Mutant]] = {}
    for mutant in plan.mutants:
        items.setdefault(mutant.ladder or mutant.id, []).append(mutant)
    found = assign({name: _cost_of(those, baseline) for name, those in items.items()}, shard.of)
    own = {name for name, number in found.items() if number == shard.number - 1}
    mutants = [mutant for mutant in plan.mutants if (mutant.ladder or mutant.id) in own]
    return replace(plan, mutants=mutants)


def write_shard(
    journal: Journal, shard: Shard | None, part: Plan, dependencies: Dependencies | None = None
) -> None:
    """Record in the journal which part of the plan is run; nothing without a shard.

    Args:
        part: its mutants.
        dependencies: None if they are not known yet, or files change.
    """
    if shard is not None:
        depends = {**dependencies.everything, **_settings_of(dependencies.request)} if dependencies else None
        numbers = tuple(mutant.number for mutant in part.mutants)
        journal.set_meta(records.SHARD, records.ShardOf(shard.number, shard.of, numbers, depends))


def _settings_of(request: Request) -> dict[str, str]:
    """Return the other settings that decide which outcomes a campaign has."""
    sample = request.sample.text if request.sample is not None else "none"
    return {"rounds": str(request.rounds), "families": ", ".join(request.families), "sample": sample}


def _cost_of(mutants: list[Mutant], baseline: Baseline) -> float:
    most = max(_cost(mutant, baseline) for mutant in mutants) * min(len(mutants), _SEARCH)
    # two digits: what a simulator rounds otherwise on another machine is not to part mutants otherwise
    return float(f"{most:.1e}")


def _cost(mutant: Mutant, baseline: Baseline) -> float:
    rounds = range(len(baseline.tests))
    tests = [(round, test) for round in rounds for test in baseline.tests_from_first_reach(round, mutant)]
    costs = [cost(baseline.ends[key]) for key in tests]
    return _START * len(rounds) + sum(simulated + _OPERATION * count for simulated, count in costs)


# One journal of all


#: differences that are named; the rest is counted
_SHOWN = 5
#: how a campaign ends that lacks something
_INCOMPLETE = "not all shards are there"


@frozen
class ShardJournal:
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
    shard: records.ShardOf
    mutants: tuple[Mutant, ...]

    @property
    def text(self) -> str:
        """``shard 2 of 8 (b.sqlite)``."""
        return f"{self.shard.text} ({self.path})"


def refuse_strangers(parts: Sequence[ShardJournal]) -> None:
    """Raise MergeError if these are not different shards of one plan, and say what differs."""
    first, *others = parts
    by_number: dict[int, ShardJournal] = {}
    for part in parts:
        other = by_number.setdefault(part.shard.number, part)
        if other is not part:
            raise MergeError(f"{part.shard.text} is there twice: {other.path} and {part.path}")
        if part.shard.depends is None:
            raise MergeError(
                f"{part.text} ended in its baseline, or files changed meanwhile, so its plan is not known: "
                f"run it again with --shard {part.shard.number}/{part.shard.of} or leave it out"
            )
    for part in others:
        differing = _differing(first, part)
        if differing:
            more = f"; and {len(differing) - _SHOWN} more" if len(differing) > _SHOWN else ""
            raise MergeError(
                f"{part.text} and {first.text} are not of one plan: {'; '.join(differing[:_SHOWN])}{more}. "
                "Run all shards of one commit with the same options, packages and kind of machine"
            )


def _differing(old: ShardJournal, new: ShardJournal) -> list[str]:
    if old.shard.of != new.shard.of:
        return [f"one is of {new.shard.of} shards, the other of {old.shard.of}"]
    differences = changed_parts(old.shard.depends or {}, new.shard.depends or {})
    before, now = ({(mutant.id, mutant.number) for mutant in part.mutants} for part in (old, new))
    others = sorted(before ^ now)
    if others and not differences:  # else they differ for that reason
        differences = [f"{len(others)} mutants are planned in one of them alone, such as {others[0][0]}"]
    return differences


def merge(paths: Sequence[Path], target: Path, *, root: Path, room: int) -> list[str]:
    """Merge the shards' journals and recordings into one journal. Return a line for each missing part.

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
            _merge_recordings(stack, parts, target, room, {mutant.id for mutant, _ in known})
            journal.finish(_INCOMPLETE if missing else "complete")
    return missing


def found_in(path: Path) -> Path:
    """Return the journal at a path, a file or a folder. Raises MergeError if there is none."""
    places = (path, path / JOURNAL, path / HOME / JOURNAL)
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        raise MergeError(f"there is no journal {path}" + (f", nor {JOURNAL} in it" if path.is_dir() else ""))
    return found


def _opened(stack: ExitStack, path: Path) -> ShardJournal:
    refuse_tracked(path)
    if is_written(path):
        raise MergeError(f"{path} is being written by a `mutabot run`: merge it when that has ended")
    journal = stack.enter_context(JournalReader.open(path))
    meta = journal.meta()
    if records.SHARD not in meta:
        raise MergeError(
            f"{path} holds a whole campaign, not a shard: shards come from `mutabot run --shard 1/8`"
        )
    return ShardJournal(path, journal, meta, meta[records.SHARD], tuple(journal.mutants()))


def _missing(parts: Sequence[ShardJournal]) -> Iterator[str]:
    """Yield a line for each part of the whole campaign that these journals lack."""
    first = parts[0]
    of, rounds = first.shard.of, int(first.meta.get("rounds") or 1)
    there = {part.shard.number for part in parts}
    claimed = [number for part in parts for number in part.shard.mutants]
    free = len({mutant.number for mutant in first.mutants} - set(claimed))
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
        again = f"run it again with `mutabot run --shard {part.shard.number}/{of}`"
        if part.journal.set_aside:
            row = part.journal.set_aside[0]
            yield f"{part.text} holds what mutabot has not written, or what is damaged ({row}): {again}"
        ended = part.journal.finished or "killed"
        if ended != "complete":
            own = set(part.shard.mutants)
            alone = {mutant.id for mutant in part.mutants if mutant.number in own and not mutant.ladder}
            lacking = len(alone) * rounds - sum(
                outcome.mutant in alone for outcome in part.journal.outcomes()
            )
            yield (
                f"{part.text} is not complete ({ended}), {lacking} outcomes are missing: {again} and its "
                "journal, and merge again"
            )


def _meta(parts: Sequence[ShardJournal]) -> dict[str, Any]:
    """Return the campaign's description in the journals: the first shard's, with summed counts."""
    metas = [part.meta for part in parts]
    found = {key: value for key, value in metas[0].items() if key != records.SHARD}
    found["shards"] = parts[0].shard.of
    for key, together in (("started", min), ("seconds", max)):
        values = [meta[key] for meta in metas if meta.get(key) is not None]
        if values:
            found[key] = together(values)
    for key in (records.ALTERED, records.FLAKY, records.VERIFICATION, records.REPEATS):
        known = [meta[key] for meta in metas if key in meta]
        if known and key == records.FLAKY:
            tests = dict.fromkeys(test for value in known for test in value.tests)
            found[key] = records.Flaky(tuple(tests), max(value.known for value in known))
        elif known:
            found[key] = _summed([to_data(value) for value in known])
    return found


def _summed(values: Sequence[Any]) -> Any:
    """Return the sum of data of one shape: numbers are added, lists concatenated."""
    first = values[0]
    if isinstance(first, dict):
        return {key: _summed([value[key] for value in values]) for key in first}
    return [item for value in values for item in value] if isinstance(first, list) else sum(values)


def _known(journal: Journal, parts: Sequence[ShardJournal]) -> list[tuple[Mutant, bool]]:
    """Return mutants of earlier campaigns beside the plan; the last shard's description counts."""
    planned = parts[0].mutants
    readers = [journal, *(part.journal for part in parts)]
    found = {mutant.id: (mutant, outdated) for part in readers for mutant, outdated in part.known()}
    for mutant in planned:
        found.pop(mutant.id, None)
    mutants = renumbered([mutant for mutant, _ in found.values()], planned)
    return [(mutant, found[mutant.id][1]) for mutant in mutants]


def _merge_recordings(
    stack: ExitStack, parts: Sequence[ShardJournal], target: Path, room: int, known: set[str]
) -> None:
    is_there = target.exists()  # a shard may lie where the whole is to lie
    found = [Recordings.to_read(part.path, copied=is_there and part.path.samefile(target)) for part in parts]
    opened = [stack.enter_context(recording) for recording in found if recording is not None]
    if opened:
        mutants = known | {mutant.id for mutant in parts[0].mutants}
        with Recordings.to_write(target, room) as recordings:
            recordings.take(opened, mutants)
