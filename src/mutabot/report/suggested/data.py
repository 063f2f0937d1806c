"""What ``mutabot suggest`` found, as data for machines."""

from __future__ import annotations

from typing import Any

from mutabot.analysis.suggested import Suggestion, Suggestions


def suggested_data(found: Suggestions) -> dict[str, Any]:
    """As docs/json.md tells it; rounds are counted from 1."""
    return {
        "rounds": found.rounds,
        "seeds": found.seeds,
        "suggestions": [_suggestion(one, found) for one in found.suggestions],
        "diff": found.diff,
        "unsolved": [
            {"mutant": _mutant(one.mutant, found), "reason": one.reason, "never": one.never}
            for one in found.unsolved
        ],
        "dropped": [
            {"test": one.test, "statement": one.statement, "reason": one.reason} for one in found.dropped
        ],
    }


def _suggestion(one: Suggestion, found: Suggestions) -> dict[str, Any]:
    return {
        "test": one.test,
        "style": one.style,
        "moment": one.moment,
        "looks_at": one.looks_at,
        "statement": one.statement,
        "tolerance": one.tolerance,
        "band": one.band,
        "factor": one.factor,
        "spread": one.spread,
        "runs": one.runs,
        "alarm": one.alarm,
        "fresh": one.fresh,
        "unseen": one.unseen,
        "kills": [
            {"mutant": _mutant(mutant, found), "rounds": [round + 1 for round in rounds]}
            for mutant, rounds in one.kills.items()
        ],
    }


def _mutant(mutant: str, found: Suggestions) -> dict[str, Any]:
    return {
        "id": mutant,
        "number": found.numbers.get(mutant),
        "description": found.descriptions.get(mutant, ""),
    }
