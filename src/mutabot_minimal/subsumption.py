"""Subsumption: which mutants are killed by whatever kills another one.

Mutant a *subsumes* mutant b if something kills a, and everything that kills a kills b too, where
"something" is a test in a round. Mutants that subsume each other form a class; a class that no other one
subsumes is a *dominator*, and one mutant of each dominator makes a smallest set whose killing kills all:
Ammann, Delamaro and Offutt, "Establishing Theoretical Minimal Sets of Mutants" (ICST 2014); Kurtz, Ammann,
Delamaro, Offutt and Deng, "Mutant Subsumption Graphs" (Mutation 2014).

It is *dynamic*: from what tests really did, so about this suite and these rounds. A test in a round stands
for a test case of these papers: with other seeds it is another one. Every test that reaches a mutant must
have been run (``Outcome.complete``).
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import TypeVar

from mutabot.api.reports import MutantResult

M = TypeVar("M", bound=Hashable)
#: a test, and a round from 0
Killer = tuple[str, int]


def killers_of(result: MutantResult) -> frozenset[Killer]:
    """Return the tests, each with its round, that kill a mutant."""
    return frozenset((test, end.round) for end in result.outcomes for test in end.noticing_tests)


def dominators(killers: Mapping[M, frozenset[Killer]]) -> tuple[tuple[M, ...], ...]:
    """Return the classes of mutants that no other class subsumes, in the order in which they first occur.

    Args:
        killers: of each mutant; those that nothing kills are in no class.
    """
    classes: dict[frozenset[Killer], list[M]] = {}
    for mutant, those in killers.items():
        if those:
            classes.setdefault(those, []).append(mutant)
    smallest: list[frozenset[Killer]] = []
    for those in sorted(classes, key=len):  # what subsumes a class is smaller, so it is found before
        if not any(other <= those for other in smallest):
            smallest.append(those)
    kept = set(smallest)
    return tuple(tuple(members) for those, members in classes.items() if those in kept)
