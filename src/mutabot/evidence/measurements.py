"""Measurements of motions and contacts that differ between the mutant and the original."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from mutabot.evidence.physics import COLLISION, DRAG, DURATION, IMPACT, MARGIN, RELEASE, SLIP, SPEED, Fact
from mutabot.model.deviation import TOLERANCES
from mutabot.model.world_difference import Measurement

if TYPE_CHECKING:
    from mutabot.evidence.differences import Spread

#: differences from which on each is worth telling: recordings have some ten moments a second
LEAST = {
    RELEASE: 0.01,
    IMPACT: 0.1,
    SLIP: 0.005,
    DRAG: 0.02,
    SPEED: 0.05,
    COLLISION: 0.0,
    DURATION: 0.5,
    MARGIN: 1e-6,
}
#: share of the original's greatest speed from which on another one is worth telling
_FASTER = 0.2
#: share of the original's least margin below which another one is worth telling
_NEARER = 0.5

FactsByName = Mapping[tuple[str, str], Fact]


def measurements_of(
    original: FactsByName, mutant: FactsByName, spread: Spread, *, is_cut: bool
) -> list[Measurement]:
    """Return the differences that exceed the original's own spread, largest deviation first.

    ``is_cut``: whether the mutant's test ended early, so that only what exceeds the original counts.
    """
    found = list(_measured(original, mutant, spread, is_cut=is_cut))
    heights = {measurement.thing for measurement in found if measurement.name == RELEASE}
    found = [
        measurement for measurement in found if measurement.name != IMPACT or measurement.thing in heights
    ]
    return sorted(
        found, key=lambda measurement: (-measurement.deviation, measurement.name, measurement.thing)
    )


def _measured(
    original: FactsByName, mutant: FactsByName, spread: Spread, *, is_cut: bool
) -> Iterator[Measurement]:
    for key, fact in mutant.items():
        usual = original.get(key)
        if fact.name == COLLISION:
            if usual is not None or tuple(sorted(fact.thing.split(", ", 1))) in spread.ever:
                continue
        elif usual is None and fact.name not in (SLIP, DRAG):
            continue
        before = usual.value if usual is not None else None
        more, least = fact.value - (before or 0.0), LEAST[fact.name]
        if is_cut and (fact.name == DURATION or (more < 0.0 and fact.name != MARGIN)):
            continue
        if fact.name == MARGIN and fact.value > _NEARER * (before or 0.0):
            continue
        unit = fact.unit
        by_itself = spread.measured.get(key, 0.0)
        least = max(least, _FASTER * (before or 0.0)) if fact.name == SPEED else least
        if abs(more) > max(least, by_itself) or fact.name == COLLISION:
            tolerance = TOLERANCES.get(unit, least)
            yield Measurement(fact.name, fact.thing, unit, fact.value, before, fact.at, tolerance, by_itself)
