"""After the baseline: variables for variables, and only what fits the types that were seen."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from mutabot.faults import Planted
from mutabot.model.alternative import Alternative, ProgramText, Sighting, TextPlace

from . import registry
from .mutants import planted_of
from .operator import ClassicalOperator

#: kinds of values that fit what an alternative needs
FITTING: Mapping[str, frozenset[str]] = {
    "number": frozenset({"number", "integer"}),
    "integer": frozenset({"integer"}),
    "truth": frozenset({"truth"}),
    "bits": frozenset({"integer", "truth", "set", "flag"}),
}


def merge(sightings: Iterable[Sighting]) -> dict[int, Sighting]:
    """What several sessions saw, by place: all kinds, and the variables that each of them saw."""
    merged: dict[int, Sighting] = {}
    for seen in sightings:
        before = merged.get(seen.place)
        if before is not None:
            kinds = tuple(sorted({*before.kinds, *seen.kinds}))
            variables = tuple(name for name in before.variables if name in seen.variables)
            seen = Sighting(seen.place, before.hits + seen.hits, kinds, variables)  # noqa: PLW2901
        merged[seen.place] = seen
    return merged


def refine(
    texts: Iterable[ProgramText], seen: Mapping[int, Sighting], operators: Iterable[str] | None = None
) -> tuple[tuple[ProgramText, ...], list[Planted]]:
    """The texts with alternatives for variables added, and what does not fit the types left out.

    ``operators``: names of those whose alternatives these are; all if left out.

    Numbers of places stay; places that have no alternative any more are gone.
    """
    asking = [rule for rule in registry.chosen(operators) if rule.asks_variables]
    refined: list[ProgramText] = []
    left_out: list[Planted] = []
    for text in texts:
        places: list[TextPlace] = []
        for place in text.places:
            alternatives: list[Alternative] = []
            for index, alternative in enumerate(place.alternatives):
                reason = _reason(alternative, seen.get(place.number))
                if reason is None:
                    alternatives.append(alternative)
                else:
                    left_out.append(planted_of(place, index, reason))
            declared = text.declared.get(place.span.function, ())
            alternatives += _variables(asking, place, seen.get(place.number), declared)
            if alternatives:
                places.append(replace(place, alternatives=tuple(alternatives)))
        refined.append(replace(text, places=tuple(places)))
    return tuple(refined), left_out


def _variables(
    asking: Iterable[ClassicalOperator], place: TextPlace, seen: Sighting | None, declared: tuple[str, ...]
) -> list[Alternative]:
    if not place.variable or seen is None:
        return []
    names = [name for name in seen.variables if name not in declared]
    return [replace(one, family=rule.family) for rule in asking for one in rule.with_variables(names)]


def _reason(alternative: Alternative, seen: Sighting | None) -> str | None:
    """Why an alternative does not fit; None if it does."""
    if not alternative.needs:
        return None
    if seen is None or not seen.kinds:
        return "no test reaches it, so its type is not known"
    if FITTING[alternative.needs].isdisjoint(seen.kinds):
        return f"its value is {' or '.join(seen.kinds)}, never {alternative.needs}"
    return None
