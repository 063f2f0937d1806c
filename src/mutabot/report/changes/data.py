"""What differs between two campaigns, as JSON-like data; docs/reports.md describes it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from mutabot.analysis.results import MutantResult
from mutabot.analysis.score import Group
from mutabot.analysis.stored.changes import Changes, Pair
from mutabot.report.as_json import FORMAT, mutant_data
from mutabot.report.shaping.status import status_of


def changes_data(changes: Changes) -> dict[str, Any]:
    """Everything about a comparison with an older campaign."""
    return {
        "format": FORMAT,
        "old_state": changes.old_state,
        "new_state": changes.new_state,
        "notes": list(changes.notes),
        "same_survivors": changes.same,
        "new_survivors": _pairs(changes.appeared),
        "fixed_survivors": _pairs(changes.fixed),
        "changed_survivors": _pairs(changes.changed),
        "unknown_survivors": _pairs(changes.unknown),
        "gone_mutants": [
            {**mutant_data(one.mutant), "old": _result(one), "new": None} for one in changes.gone
        ],
        "new_mutants": [
            {**mutant_data(one.mutant), "old": None, "new": _result(one)} for one in changes.added
        ],
        "groups": [
            {"family": family, "role": role, "old": _score(old), "new": _score(new)}
            for (family, role), (old, new) in changes.scores.items()
        ],
    }


def _pairs(pairs: Iterable[Pair]) -> list[dict[str, Any]]:
    return [
        {**mutant_data(pair.either.mutant), "old": _result(pair.old), "new": _result(pair.new)}
        for pair in pairs
    ]


def _result(result: MutantResult | None) -> dict[str, Any] | None:
    if result is None:
        return None
    status = status_of(result)
    return {
        "status": status.value if status is not None else None,
        "rounds": [one.verdict.value if one is not None else None for one in result.rounds],
        "killed": result.kill_rate.killed,
        "valid": result.kill_rate.valid,
        "indistinguishable": result.indistinguishable,
        "why": result.why,
    }


def _score(group: Group | None) -> dict[str, Any] | None:
    if group is None:
        return None
    return {"mutants": group.mutants, "score": group.scores.mean, "check_score": group.scores.mean_check}
