"""Makes mutants of alternatives, after the baseline only of those that fit the observed types."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from mutabot.api.faults import Alternative, Original, PlannedMutant, ProgramText, TextPlace

from . import registry
from .extension import PROVIDER
from .nodes import shortened
from .operator import ConventionalOperator


def plan_mutants(texts: Iterable[ProgramText]) -> list[PlannedMutant]:
    """Return all mutants of these texts, in the order of the text."""
    return [
        planned_mutant(place, index)
        for text in texts
        for place in text.places
        for index in range(len(place.alternatives))
    ]


def planned_mutant(place: TextPlace, index: int, reason: str | None = None) -> PlannedMutant:
    """Return the mutant of an alternative at a place; ``reason`` says why it is left out, if it is."""
    description = f"{place.text} → {shortened(place.alternatives[index].text)}"
    return PlannedMutant.of_text(PROVIDER, place, index, description, reason)


def refine(
    texts: Iterable[ProgramText],
    original: Original,
    operators: Iterable[str] | None = None,
) -> tuple[tuple[ProgramText, ...], list[PlannedMutant]]:
    """Return the texts with alternatives for variables, and the mutants left out as their types do not fit.

    ``operators``: names of those whose alternatives these are; all if left out. Of places that no test
    reaches the types are not known, so nothing is left out that could fit: what stands there is not covered.

    Numbers of places stay; places that have no alternative any more are gone.
    """
    asking = [rule for rule in registry.select(operators) if rule.asks_variables]
    sightings, reached = original.sightings(), original.reached_places()
    refined: list[ProgramText] = []
    left_out: list[PlannedMutant] = []
    for text in texts:
        places: list[TextPlace] = []
        names = _read_in_functions(text)
        for place in text.places:
            alternatives: list[Alternative] = []
            is_reached = place.number in reached
            seen = sightings.get(place.number)
            kinds, around = (seen.kinds, seen.variables) if seen is not None else ((), ())
            for index, alternative in enumerate(place.alternatives):
                reason = _reason(alternative, kinds) if is_reached else None
                if reason is None:
                    alternatives.append(alternative)
                else:
                    left_out.append(planned_mutant(place, index, reason))
            if not is_reached:  # any of its function's may have the same type
                around = tuple(name for name in names[place.span.function] if name != place.text)
            declared = text.declared.get(place.span.function, ())
            alternatives += _variables(asking, place, around, declared)
            if alternatives:
                places.append(replace(place, alternatives=tuple(alternatives)))
        refined.append(replace(text, places=tuple(places)))
    return tuple(refined), left_out


def _variables(
    asking: Iterable[ConventionalOperator], place: TextPlace, around: Iterable[str], declared: tuple[str, ...]
) -> list[Alternative]:
    if not place.variable:
        return []
    names = [name for name in around if name not in declared]
    return [
        replace(alternative, family=rule.family)
        for rule in asking
        for alternative in rule.with_variables(names)
    ]


def _read_in_functions(text: ProgramText) -> dict[str, list[str]]:
    """Return the names of the variables that each function reads."""
    found: dict[str, set[str]] = {}
    for place in text.places:
        found.setdefault(place.span.function, set()).update([place.text] if place.variable else ())
    return {function: sorted(names) for function, names in found.items()}


def _reason(alternative: Alternative, kinds: Iterable[str]) -> str | None:
    """Return why an alternative does not fit a place with values of these kinds; None if it does."""
    if alternative.fits(kinds):
        return None
    text = " or ".join(kind.removeprefix("builtins:") for kind in kinds)
    return f"its value is {text}, never {alternative.needs}" if text else "the type of its value was not seen"
