"""JSON Lines: an object per mutant, and a last one about the campaign. ``mutabot run`` streams them."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING, Any

from mutabot.report.document import finite
from mutabot.report.texts import effect_text, one_line, state_of
from mutabot.results.results import Encoder

if TYPE_CHECKING:
    from mutabot.report.format import Material
    from mutabot.results.results import MutantResult, Results

_LINE = (
    "number=mutant.number id=mutant.id file=mutant.site.span.file line=mutant.site.span.line "
    "function=mutant.site.span.function operator=mutant.operator family=mutant.family role=mutant.site.role "
    "description=mutant.description killed=kill_rate.killed valid=kill_rate.valid"
)
_GROUP = "family role score=scores.mean check_score=scores.mean_check accepted=scores.accepted"
_DATA_OF = Encoder({})


def make(material: Material) -> str:
    """Return the report."""
    campaign = material.campaign
    found = (mutant_line(one) for one in campaign.mutants)
    return "".join(f"{line}\n" for line in (*found, end_line(campaign)))


def mutant_line(result: MutantResult) -> str:
    """Return the line of a mutant."""
    return _dumped({"event": "mutant", **mutant_data(result)})


def mutant_data(result: MutantResult) -> dict[str, Any]:
    """Return what is said of a mutant: its state, where and what it is, and why it has this state."""
    deciding = next((one for one in result.outcomes if one.test is not None), None)
    return {
        "status": state_of(result),
        **_DATA_OF.facts(result, _LINE),
        "test": deciding.test if deciding is not None else None,
        "why": one_line(effect_text(result)),
        "accepted": result.acceptance.why if result.acceptance is not None and result.is_accepted else None,
    }


def end_line(results: Results) -> str:
    """Return the last line: how the campaign ended, counts of mutants and scores."""
    return _dumped({"event": "end", **end_data(results)})


def end_data(results: Results) -> dict[str, Any]:
    """Return what is said of a campaign."""
    return {
        "state": results.state,
        "mutants": dict(Counter(map(state_of, results.mutants))),
        "scores": [_DATA_OF.facts(group, _GROUP) for group in results.groups],
        "untested": results.untested.text,
    }


def _dumped(data: dict[str, Any]) -> str:
    return json.dumps(finite(data), ensure_ascii=False, default=str)
