"""A campaign as JSON; the format is described in docs/json.md."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable
from typing import Any

from mutabot.analysis.chance import Confirmed, Estimate, false_kills, false_survivors
from mutabot.analysis.results import MutantResult, Results
from mutabot.analysis.score import Group, RoundScores, Score
from mutabot.analysis.statistics import Interval
from mutabot.border.codec import to_data
from mutabot.journal.records import (
    ALTERED,
    BUDGET,
    CONFIRMATION,
    DRAWING,
    DRAWS,
    FLAKY,
    OPERATORS,
    REACHING,
    REPEATS,
    SHARD,
    SINCE,
    VERIFICATION,
    Drawing,
    Repeats,
    Replayed,
    Verification,
)
from mutabot.model import Mutant, Outcome, Verdict

#: raised when a key changes its meaning or goes away; new keys do not raise it
FORMAT = 1
#: facts of a campaign that are not repeated as they are in the journal
_ELSEWHERE = {
    "vocabulary", VERIFICATION, FLAKY, DRAWING, REPEATS, OPERATORS, REACHING, DRAWS,
    SINCE, BUDGET, SHARD, ALTERED, CONFIRMATION,
}  # fmt: skip


def dumps(data: Any) -> str:
    """Valid JSON for any data of ours: numbers that JSON cannot hold become null."""
    return json.dumps(finite(data), indent=2, ensure_ascii=False, default=str)


def facts(one: object, names: str) -> dict[str, Any]:
    """These attributes of something, in this order, as JSON-like data."""
    return {name: to_data(getattr(one, name)) for name in names.split()}


def results_data(results: Results) -> dict[str, Any]:
    """Everything about a campaign, as JSON-like data."""
    return {
        "format": FORMAT,
        "state": results.state,
        "finished": results.state == "complete",
        "attempt": results.attempt,
        "meta": {key: value for key, value in results.meta.items() if key not in _ELSEWHERE},
        "rounds": _score_rounds(results.all),
        "groups": [group_data(group) for group in results.groups],
        "mutants": [result_data(result) for result in results.mutants],
        "graded": [result_data(result) for result in results.graded],
        "left_out": [facts(item, "id description reason") for item in results.left_out],
        "controls": [facts(one, "test_file control ok detail") for one in results.controls],
        "baseline": [
            {
                "test": one.test.test,
                "round": one.round + 1,
                "repetition": one.repetition + 1,
                **facts(one.test, "outcome wall simulated"),
            }
            for one in results.baseline
        ],
        "sample": drawing_data(results.drawing),
        "since": to_data(results.since),
        "budget": to_data(results.budget),
        "flaky": list(results.flaky.tests),
        "verification": verification_data(results.verification),
        "repeats": repeats_data(results.repeats),
        "confirmation": _confirmation(results.confirmation),
        "shard": facts(results.shard, "number of mutants") if results.shard is not None else None,
        **facts(results, "set_aside altered"),
    }


def mutant_data(mutant: Mutant) -> dict[str, Any]:
    """One mutant as planned."""
    span = mutant.site.span
    return {
        **facts(mutant, "id number operator variant family"),
        "role": mutant.site.role.value,
        "file": span.file,
        "span": {
            "line": span.line,
            "column": span.column + 1,
            "end_line": span.end_line,
            "end_column": span.end_column + 1,
        },
        "function": span.function,
        "call": mutant.site.text,
        **facts(mutant, "operation pattern quantity description magnitude unit"),
        "direction": mutant.direction or None,
        "ladder": mutant.ladder or None,
        "moment": mutant.moment.text if mutant.moment is not None else None,
    }


def result_data(result: MutantResult) -> dict[str, Any]:
    """One mutant with what became of it."""
    rate, meaning = result.kill_rate, result.quantity
    return {
        **mutant_data(result.mutant),
        "meaning": facts(meaning, "kind axis unit frame mode") if meaning is not None else None,
        "rounds": [_round_data(number, one) for number, one in enumerate(result.rounds, start=1)],
        "kill_rate": {
            **facts(rate, "killed valid"),
            "rate": rate.score,
            "interval": interval_data(rate.interval),
        },
        "survivor": result.is_survivor,
        "indistinguishable": result.indistinguishable,
        "distance": result.distance if result.is_survivor else None,
        "worst": result.worst if result.is_survivor else None,
        **facts(result, "why earlier outdated"),
    }


def score_data(score: Score) -> dict[str, Any]:
    """A score with its counts."""
    return {
        **facts(score, "score check_score killed valid by_check timeouts"),
        "counts": {verdict.value: score.counts.get(verdict, 0) for verdict in Verdict},
    }


def group_data(group: Group) -> dict[str, Any]:
    """The scores of a family and role."""
    return {**facts(group, "family role mutants population"), **scores_data(group.scores)}


def scores_data(scores: RoundScores) -> dict[str, Any]:
    """Scores over the rounds: the mean, the counts of all rounds together, and each round."""
    return {
        **score_data(scores.total),
        "score": scores.mean,
        "check_score": scores.mean_check,
        "interval": interval_data(scores.interval),
        "check_interval": interval_data(scores.check_interval),
        "sample_interval": interval_data(scores.sample_interval),
        "sample_check_interval": interval_data(scores.sample_check_interval),
        "rounds": _score_rounds(scores),
    }


def _score_rounds(scores: RoundScores) -> list[dict[str, Any]]:
    return [{"round": number, **score_data(one)} for number, one in enumerate(scores.rounds, start=1)]


def replayed_data(mutant: Mutant, rounds: Iterable[Replayed]) -> dict[str, Any]:
    """One mutant that was run again, beside its outcomes in the journal."""
    return {
        **facts(mutant, "id number"),
        "rounds": [
            {
                "round": one.round + 1,
                "agrees": one.agrees,
                "journal": _round_data(one.round + 1, one.first),
                "replay": _round_data(one.round + 1, one.second),
            }
            for one in rounds
        ],
    }


def verification_data(found: Verification | None) -> dict[str, Any] | None:
    """What was run again in fresh processes, and what came out otherwise; None if nothing was."""
    if found is None:
        return None
    return {
        **facts(found, "wanted checked agreed"),
        "disagreements": [
            {"id": one.mutant, "number": one.number, "round": one.round + 1, **facts(one, "first second")}
            for one in found.disagreements
        ],
    }


def _confirmation(found: Confirmed | None) -> dict[str, Any] | None:
    return (
        facts(found, "outcomes refused confirmed wrong left most level text") if found is not None else None
    )


def repeats_data(repeats: Repeats) -> dict[str, Any]:
    """What was run once more, and what that says about the others."""
    stratum = "outcomes repeated changed"
    return {
        "doubted": facts(repeats.doubted, stratum),
        "others": facts(repeats.others, stratum),
        "certain": repeats.certain,
        "survivors": facts(repeats.survivors, stratum),
        "false_kills": _estimate(false_kills(repeats)),
        "false_survivors": _estimate(false_survivors(repeats)),
    }


def _estimate(found: Estimate | None) -> dict[str, Any] | None:
    return facts(found, "expected low high level known unknown") if found is not None else None


def _round_data(number: int, outcome: Outcome | None) -> dict[str, Any]:
    if outcome is None:
        return {"round": number, "verdict": None}
    return {
        "round": number,
        **facts(outcome, "verdict by test exception message place hits acted away"),
        "example": list(outcome.example) if outcome.example is not None else None,
        **facts(outcome, "tests wall simulated indistinguishable distance divergence way gaps compared"),
        **facts(outcome, "engine stuck repeats beside confirmed"),
        "figures": [{**to_data(one), "is_better": one.is_better} for one in outcome.figures],
        "looked": [to_data(one) for one in outcome.looked],
        "diverged": [{**to_data(one), "worst": one.worst} for one in outcome.diverged],
    }


def drawing_data(drawing: Drawing | None) -> dict[str, Any] | None:
    """How the mutants were drawn, or None if all of them were run."""
    return {"size": drawing.sample, "selected": drawing.selected} if drawing is not None else None


def interval_data(interval: Interval | None) -> dict[str, Any] | None:
    """An interval with its level, or None."""
    return facts(interval, "low high level") if interval is not None else None


def finite(value: Any, number: Callable[[float], float] = float) -> Any:
    """Data that JSON can hold: numbers that are none become null, others what ``number`` makes of them."""
    if isinstance(value, dict):
        return {str(key): finite(item, number) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item, number) for item in value]
    if isinstance(value, float):
        return number(value) if math.isfinite(value) else None
    return value
