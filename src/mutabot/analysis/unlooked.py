"""Readings that the tests take and nobody looks at: whatever was done to them, no test noticed."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.frozen import frozen
from mutabot.model import Role

from .results import MutantResult


@frozen
class Unlooked:
    """A part of what an operation reads for the tests.

    Attributes:
        operation: the operation, as the vocabulary names it.
        quantity: the part, as the vocabulary names it.
        places: ``file:line:column`` of the calls.
        mutants: how many mutants of it there were, none of which was noticed.
    """

    operation: str
    quantity: str
    places: tuple[str, ...]
    mutants: int

    @property
    def text(self) -> str:
        """``tests/sensors.py:12:5 tracker:robot_position .y: none of its 3 mutants was noticed``."""
        more = f" and {len(self.places) - 1} more" if len(self.places) > 1 else ""
        which = "its only mutant was not" if self.mutants == 1 else f"none of its {self.mutants} mutants was"
        return f"{self.places[0]}{more} {self.operation} {self.quantity}: {which} noticed"


def unlooked(results: Iterable[MutantResult]) -> tuple[Unlooked, ...]:
    """Such readings of the oracle, in the order of their mutants; only those that were judged count.

    Of a reading with a mutant that is still to be run, as in another shard, nothing is said.
    """
    groups: dict[tuple[str, str], list[MutantResult]] = {}
    open_ones: set[tuple[str, str]] = set()
    for one in results:
        mutant = one.mutant
        is_reading = mutant.site.role is Role.ORACLE and mutant.operation and mutant.quantity
        key = (mutant.operation, mutant.quantity or "")
        if is_reading and not one.outdated and one.kill_rate.valid:
            groups.setdefault(key, []).append(one)
        elif is_reading and not one.outcomes and not mutant.ladder:  # of a ladder, a search runs some
            open_ones.add(key)
    return tuple(
        Unlooked(*key, tuple(dict.fromkeys(one.mutant.site.place for one in found)), len(found))
        for key, found in groups.items()
        if key not in open_ones and not any(one.kill_rate.killed for one in found)
    )
