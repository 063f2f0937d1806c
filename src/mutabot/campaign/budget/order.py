"""The order of what is run in limited time: what is expected to tell most comes first.

Among those that are expected to tell alike much the order is random. It depends on the seed and the mutants'
ids alone.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from hashlib import blake2b

from mutabot.campaign.engines.engine import Trial
from mutabot.model import Mutant, Verdict

Pair = tuple[str, int]


def in_order(
    mutants: Sequence[Mutant],
    rounds: int,
    done: Iterable[Pair],
    seed: int,
    before: Mapping[Pair, Verdict],
    sites: Collection[str],
) -> list[Trial]:
    """All that is not done, what is expected to tell most first; one round after the other.

    Args:
        before: what outcomes were that do not hold any more.
        sites: mutants, by id, at which something else stands than when they were run.
    """
    done = set(done)
    firsts = _one_per_site(mutants, seed)

    def rank(trial: Trial) -> int:
        mutant, round = trial
        return _rank(before.get((mutant.id, round)), mutant.id in sites, mutant.id in firsts)

    found: list[Trial] = []
    for round in range(rounds):
        shuffled = _shuffled(mutants, f"{seed}:budget:{round}")
        left = [(mutant, round) for mutant in shuffled if (mutant.id, round) not in done]
        found += sorted(left, key=rank)
    return found


def _rank(before: Verdict | None, is_changed: bool, is_first: bool) -> int:
    """Never run before, survivors, at changed sites, the rest; of the first and last one per site first."""
    if before is None:
        return 0 if is_first else 1
    if before.is_valid and not before.is_killed:
        return 2
    if is_changed:
        return 3
    return 4 if is_first else 5


def _one_per_site(mutants: Sequence[Mutant], seed: int) -> set[str]:
    chosen: dict[tuple[str, object], str] = {}
    for mutant in _shuffled(mutants, f"{seed}:site"):
        chosen.setdefault((mutant.family, mutant.site), mutant.id)
    return set(chosen.values())


def _shuffled(mutants: Iterable[Mutant], salt: str) -> list[Mutant]:
    return sorted(mutants, key=lambda one: blake2b(f"{salt}:{one.id}".encode(), digest_size=16).digest())
