"""Chooses the fewest tests that show how each survivor differs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence

from mutabot.api.reports import MutantResult

from .project import PlaceInTest, SuiteFiles, place_of

#: tests that are looked at for a survivor of which nothing was recorded
_MOST = 6
#: share of a survivor's largest deviation from which on a test shows it as well
_ALSO = 0.5


def chosen_places(project: SuiteFiles, survivors: Sequence[MutantResult]) -> list[PlaceInTest]:
    """Return the fewest tests that show every survivor's difference, each with all of its parameters.

    Where ends differ and where only the way does are looked for apart. A test whose end the original itself
    scatters counts only where no other shows a survivor.
    """
    variants: dict[PlaceInTest, set[str]] = {}
    wanted: list[set[PlaceInTest]] = []
    for survivor in survivors:
        acted = [looked.test for out in survivor.survived for looked in out.looked if looked.acted]
        for test in acted:
            place = place_of(project, test)
            if place is not None:
                variants.setdefault(place, set()).add(test)
        for weights in _weights(survivor):
            known = {place: weight for test, weight in weights.items() if (place := place_of(project, test))}
            most = max(known.values(), default=0.0)
            if known:
                wanted.append({place for place, weight in known.items() if weight >= _ALSO * most})
        if not any(out.diverged for out in survivor.survived):
            wanted += [{place} for test in acted if (place := place_of(project, test))][:_MOST]
    chosen: list[PlaceInTest] = []
    left = wanted
    while left:
        there = sorted({place for group in left for place in group}, key=lambda place: place.node)
        counts = {place: sum(place in places_of_test for places_of_test in left) for place in there}
        best = max(counts, key=lambda place: (counts[place], -len(variants.get(place, ()))))
        chosen.append(best)
        left = [group for group in left if best not in group]
    return chosen


def other_places(
    project: SuiteFiles,
    survivors: Sequence[MutantResult],
    unnoticed: Sequence[MutantResult],
    places: Collection[PlaceInTest],
) -> list[PlaceInTest]:
    """Return a further test in the same files for each survivor that no check would notice in these places.

    That is the test that shows it and in which the fewest survivors act: where a program does little, a path
    has bounds that it has not where the program does all.
    """
    acting: Counter[PlaceInTest] = Counter()
    for survivor in survivors:
        acted = {looked.test for out in survivor.survived for looked in out.looked if looked.acted}
        acting.update({place for test in acted if (place := place_of(project, test))})
    files, chosen = {known_place.file for known_place in places}, dict[PlaceInTest, None]()
    for survivor in unnoticed:
        tests = (test for test, weight in _weights(survivor)[-1].items() if weight > 1.0)
        known = [place for test in tests if (place := place_of(project, test)) and place.file in files]
        others = [place for place in known if place not in places]
        if others:
            chosen[min(others, key=lambda place: acting[place])] = None
    return list(chosen)


def _weights(survivor: MutantResult) -> list[Mapping[str, float]]:
    """Return how far a survivor is from the original in each test: at the end, and on the way."""
    found = [divergence for out in survivor.survived for divergence in out.diverged]
    stable = [divergence for divergence in found if not divergence.scatters] or found
    ends = {
        divergence.test: max((part.of_end for part in divergence.apart), default=0.0) for divergence in stable
    }
    return [
        {test: weight for test, weight in ends.items() if weight > 1.0},
        {divergence.test: divergence.deviation for divergence in stable},
    ]
