"""The order of what is run in limited time: what is expected to tell most comes first.

Outcomes fall into classes, which follow one another; within a class the order is random, so that those which
are run are a fair sample of the class. It depends on the seed and the mutants' ids alone.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b

from mutabot.campaign.engines.engine import Trial
from mutabot.model import Mutant, Verdict

Pair = tuple[str, int]
#: the classes, in their order; those never run come first, one per site before the others
NEVER_SITE, NEVER = "never run before, one per site", "never run before, the others"
SURVIVED, CHANGED = "survivors before", "at changed sites"
REST_SITE, REST = "the rest, one per site", "the rest, the others"
_ORDER = (NEVER_SITE, NEVER, SURVIVED, CHANGED, REST_SITE, REST)


@dataclass(frozen=True, slots=True)
class Class:
    """Outcomes that are expected to tell alike much.

    Attributes:
        name: what they have in common.
        round: 0-based round.
        trials: the outcomes, in random order.
    """

    name: str
    round: int
    trials: tuple[Trial, ...]


def in_order(
    mutants: Sequence[Mutant],
    rounds: int,
    done: Iterable[Pair],
    seed: int,
    before: Mapping[Pair, Verdict],
    sites: Collection[str],
) -> list[Class]:
    """The classes of all that is not done, one round after the other.

    Args:
        before: what outcomes were that do not hold any more.
        sites: mutants, by id, at which something else stands than when they were run.
    """
    done = set(done)
    firsts = _one_per_site(mutants, seed)
    classes = []
    for round in range(rounds):
        found: dict[str, list[Trial]] = {}
        for mutant in _shuffled(mutants, f"{seed}:budget:{round}"):
            pair = (mutant.id, round)
            if pair not in done:
                name = _class_of(before.get(pair), mutant.id in sites, mutant.id in firsts)
                found.setdefault(name, []).append((mutant, round))
        classes += [Class(name, round, tuple(found[name])) for name in _ORDER if name in found]
    return classes


def _class_of(before: Verdict | None, is_changed: bool, is_first: bool) -> str:
    if before is None:
        return NEVER_SITE if is_first else NEVER
    if before.is_valid and not before.is_killed:
        return SURVIVED
    if is_changed:
        return CHANGED
    return REST_SITE if is_first else REST


def _one_per_site(mutants: Sequence[Mutant], seed: int) -> set[str]:
    chosen: dict[tuple[str, object], str] = {}
    for mutant in _shuffled(mutants, f"{seed}:site"):
        chosen.setdefault((mutant.family, mutant.site), mutant.id)
    return set(chosen.values())


def _shuffled(mutants: Iterable[Mutant], salt: str) -> list[Mutant]:
    return sorted(mutants, key=lambda one: blake2b(f"{salt}:{one.id}".encode(), digest_size=16).digest())
