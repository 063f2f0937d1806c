"""The minimal set of a campaign's mutants: one list of all families, in which nothing counts twice.

Left out are killed mutants that another one subsumes, and survivors that make the same change to the same
place as another. Only mutants of the program are looked at: those of what tests read judge something else.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from mutabot.api.reports import MutantResult, Results

from .subsumption import Killer, dominators, killers_of

PROGRAM = "program"


@dataclass(frozen=True)
class KeptMutant:
    """A mutant of the minimal set.

    Attributes:
        number, id, family, operator, place, description: of the mutant; of a class, of its first one.
        killed_by: how many tests kill it, over all rounds; 0 for a survivor.
        stands_for: mutants left out that whatever kills this one kills, too; of a survivor, those that make
            the same change.
    """

    number: int
    id: str
    family: str
    operator: str
    place: str
    description: str
    killed_by: int
    stands_for: int


@dataclass(frozen=True)
class FamilyShare:
    """What a family adds.

    Attributes:
        family: its name.
        mutants: how many were valid in any round.
        killed: of these, how many some test kills.
        minimal: dominators of this family alone.
        joint: dominators of all families that hold a mutant of this one.
        alone: dominators that hold no mutant of any other family.
    """

    family: str
    mutants: int
    killed: int
    minimal: int
    joint: int
    alone: int


@dataclass(frozen=True)
class Minimal:
    """A minimal set.

    Attributes:
        families: each family's share, in the order of their mutants' numbers.
        mutants: how many were valid in any round.
        killed: of these, how many some test kills.
        dominators: one mutant of each killed class that no other one subsumes.
        survivors: one of those that no test kills and that make the same change.
        unknown: killed mutants of which not every test was run; they are in no class.
        seconds: how long the campaign took, with every test on every mutant; None if that is not known.
    """

    families: tuple[FamilyShare, ...]
    mutants: int
    killed: int
    dominators: tuple[KeptMutant, ...]
    survivors: tuple[KeptMutant, ...]
    unknown: int
    seconds: float | None

    @property
    def size(self) -> int:
        """How many mutants are left."""
        return len(self.dominators) + len(self.survivors)


def minimal_of(results: Results) -> Minimal | None:
    """Return the minimal set of a campaign; None if it stopped at the first test that noticed a mutant."""
    if not results.meta.get("every_test"):
        return None
    valid = [
        result
        for result in results.mutants
        if result.mutant.site.role.value == PROGRAM
        and any(outcome.verdict.is_valid for outcome in result.outcomes)
    ]
    by_number = {result.mutant.number: result for result in valid}
    killers = {number: killers_of(result) for number, result in by_number.items()}
    incomplete = {
        number for number, those in killers.items() if those and not _is_complete(by_number[number])
    }
    known = {number: those for number, those in killers.items() if those and number not in incomplete}
    classes = dominators(known)
    home = {number: result.mutant.family for number, result in by_number.items()}
    homes = [{home[number] for number in members} for members in classes]
    seconds = results.meta.get("seconds")
    return Minimal(
        tuple(_share(family, home, killers, known, homes) for family in dict.fromkeys(home.values())),
        len(valid),
        sum(map(bool, killers.values())),
        tuple(_dominator(by_number[members[0]], known[members[0]], known) for members in classes),
        tuple(_survivors([by_number[number] for number, those in killers.items() if not those])),
        len(incomplete),
        float(seconds) if isinstance(seconds, int | float) else None,
    )


def section(results: Results) -> dict[str, object] | None:
    """Return the minimal set as data of the results document; None without one."""
    found = minimal_of(results)
    return None if found is None else {"size": found.size, **vars(found)}


def _is_complete(result: MutantResult) -> bool:
    return all(outcome.complete for outcome in result.outcomes if outcome.verdict.is_killed)


def _share(
    family: str,
    home: Mapping[int, str],
    killers: Mapping[int, frozenset[Killer]],
    known: Mapping[int, frozenset[Killer]],
    homes: Sequence[set[str]],
) -> FamilyShare:
    own = [number for number in killers if home[number] == family]
    return FamilyShare(
        family,
        len(own),
        sum(bool(killers[number]) for number in own),
        len(dominators({number: known[number] for number in own if number in known})),
        sum(family in there for there in homes),
        sum(there == {family} for there in homes),
    )


def _dominator(
    result: MutantResult, own: frozenset[Killer], known: Mapping[int, frozenset[Killer]]
) -> KeptMutant:
    return _kept(result, len(own), sum(own <= those for those in known.values()) - 1)


def _survivors(results: Iterable[MutantResult]) -> list[KeptMutant]:
    """One of those that make the same change, without accepted ones."""
    firsts: dict[tuple[str, str], MutantResult] = {}
    counts: Counter[tuple[str, str]] = Counter()
    for result in results:
        if result.is_survivor:
            change = result.mutant.site.id, result.mutant.description
            firsts.setdefault(change, result)
            counts[change] += 1
    return [_kept(result, 0, counts[change] - 1) for change, result in firsts.items()]


def _kept(result: MutantResult, killed_by: int, stands_for: int) -> KeptMutant:
    mutant = result.mutant
    return KeptMutant(
        mutant.number, mutant.id, mutant.family, mutant.operator, mutant.site.span.place, mutant.description,
        killed_by, stands_for,
    )  # fmt: skip
