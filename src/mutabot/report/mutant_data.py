"""Data of a mutant for formats with a line per mutant, and of the campaign for their last line."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from mutabot.model import Span
from mutabot.report.texts import effect_text, next_step, next_steps, one_line, state_of
from mutabot.results.encoder import Encoder

if TYPE_CHECKING:
    from mutabot.results.results import MutantResult, Results

_LINE = (
    "number=mutant.number id=mutant.id file=mutant.site.span.file line=mutant.site.span.line "
    "other_spans=mutant.site.other_spans function=mutant.site.span.function operator=mutant.operator "
    "family=mutant.family role=mutant.site.role "
    "description=mutant.description killed=kill_rate.killed valid=kill_rate.valid"
)
_GROUP = "family role score=scores.mean check_score=scores.mean_check accepted=scores.accepted"
#: facts of a place
SPAN = "file line column=column+1 end_line end_column=end_column+1"
_DATA_OF = Encoder({Span: SPAN})


def mutant_data(result: MutantResult) -> dict[str, Any]:
    """Return a mutant's data: its state, its place, its description, its effect, and what to do."""
    deciding = next((outcome for outcome in result.outcomes if outcome.test is not None), None)
    return {
        "status": state_of(result),
        **_DATA_OF.facts(result, _LINE),
        "test": deciding.test if deciding is not None else None,
        "effect": one_line(effect_text(result)),
        "next": next_step(result) or None,
        "accepted": result.acceptance.why if result.acceptance is not None and result.is_accepted else None,
    }


def lines_of(
    results: Results, mutant_line: Callable[[MutantResult], str], end_line: Callable[[Results], str]
) -> str:
    """Return a report with a line per mutant, and a last one about the campaign."""
    return "".join(f"{line}\n" for line in (*map(mutant_line, results.mutants), end_line(results)))


def end_data(results: Results) -> dict[str, Any]:
    """Return the data about the campaign."""
    return {
        "state": results.state,
        "mutants": dict(Counter(map(state_of, results.mutants))),
        "scores": [_DATA_OF.facts(group, _GROUP) for group in results.groups],
        "untested": results.untested.text or None,
        "next": next_steps(results) or None,
    }
