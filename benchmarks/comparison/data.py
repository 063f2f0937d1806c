"""Families side by side as JSON; the format is described in docs/compare.md."""

from __future__ import annotations

from typing import Any

from mutabot.report.document import FORMAT, data_of

from .ends import end_of
from .families import Family, FamilyComparison, Share
from .subsumption import Redundancy

#: facts of the campaign that say how the numbers came about; none names the machine
_META = (
    "mutabot", "python", "versions", "seed", "rounds", "engine", "jobs", "started", "seconds", "families",
)  # fmt: skip


def comparison_data(comparison: FamilyComparison) -> dict[str, Any]:
    """Everything about a comparison, as JSON-like data."""
    return {
        "format": FORMAT,
        "state": comparison.state,
        "finished": comparison.state == "complete",
        "meta": {key: comparison.meta.get(key) for key in _META},
        "sample": data_of(comparison.drawing),
        "families": [_family(family) for family in comparison.families],
        "together": _redundancy(comparison.redundancy),
        "mutants": _mutants(comparison),
    }


def _family(family: Family) -> dict[str, Any]:
    cost = family.cost
    return {
        "family": family.name,
        "role": family.role,
        "mutants": family.mutants,
        "population": family.population,
        "places": family.places,
        "planned": family.planned,
        "done": family.done,
        "cost": {
            "wall": cost.wall,
            "cpu": cost.cpu,
            "simulated": cost.simulated,
            "shared": cost.shared,
        },
        "ends": {end.value: _share(share) for end, share in family.ends.items()},
        "weaknesses": {name: _share(share) for name, share in family.weaknesses.items()},
        "scores": data_of(family.scores),
        "without_oracle": data_of(family.without_oracle) if family.without_oracle is not None else None,
        "valid": _share(family.valid),
        "reached": _share(family.reached),
        "trivial": _share(family.trivial),
        "indistinguishable": _share(family.indistinguishable),
        "informative": _share(family.informative),
        **_redundancy(family.redundancy),
        "joint": family.joint,
        "alone": family.alone,
    }


def _redundancy(redundancy: Redundancy) -> dict[str, Any]:
    return {
        "killed_mutants": redundancy.killed,
        "unknown_mutants": redundancy.unknown,
        "redundant": redundancy.redundant,
        "dominators": len(redundancy.dominators),
    }


def _share(share: Share) -> dict[str, Any]:
    return {
        "count": share.count,
        "of": share.of,
        "unknown": share.unknown,
        "share": share.share,
        "interval": data_of(share.interval),
    }


def _mutants(comparison: FamilyComparison) -> list[dict[str, Any]]:
    classes = {
        mutant: number
        for number, members in enumerate(comparison.redundancy.dominators, start=1)
        for mutant in members
    }
    return [
        {
            "id": result.mutant.id,
            "number": result.mutant.number,
            "family": result.mutant.family,
            "role": result.mutant.site.role.value,
            "operator": result.mutant.operator,
            "ends": [end_of(outcome).value if outcome is not None else None for outcome in result.rounds],
            "trivial": comparison.properties[result.mutant.id].trivial,
            "indistinguishable": comparison.properties[result.mutant.id].indistinguishable,
            "informative": comparison.properties[result.mutant.id].informative,
            "dominator": classes.get(result.mutant.id),
        }
        for result in comparison.results.mutants
    ]
