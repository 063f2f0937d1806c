"""A campaign as JSON; the format is described in docs/json.md."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from typing import Any

from mutabot.analysis.chance import Estimate, false_kills, false_survivors
from mutabot.analysis.results import MutantResult, Results
from mutabot.analysis.score import KillRate, RoundScores, Score
from mutabot.analysis.statistics import Interval
from mutabot.border.codec import to_data
from mutabot.journal.records import (
    ALTERED,
    BUDGET,
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
    Repeated,
    Repeats,
    Replayed,
    ShardOf,
    Verification,
)
from mutabot.model import Mutant, Outcome, Quantity, Verdict

#: raised when a key changes its meaning or goes away; new keys do not raise it
FORMAT = 1
#: facts of a campaign that are not repeated as they are in the journal
_ELSEWHERE = {
    "vocabulary", VERIFICATION, FLAKY, DRAWING, REPEATS, OPERATORS, REACHING, DRAWS,
    SINCE, BUDGET, SHARD, ALTERED,
}  # fmt: skip


def dumps(data: Any) -> str:
    """Valid JSON for any data of ours: numbers that JSON cannot hold become null."""
    return json.dumps(_finite(data), indent=2, ensure_ascii=False, default=str)


def results_data(results: Results) -> dict[str, Any]:
    """Everything about a campaign, as JSON-like data."""
    return {
        "format": FORMAT,
        "state": results.state,
        "finished": results.state == "complete",
        "attempt": results.attempt,
        "meta": {key: value for key, value in results.meta.items() if key not in _ELSEWHERE},
        "rounds": [
            {"round": number, **score_data(score)} for number, score in enumerate(results.all.rounds, start=1)
        ],
        "groups": [
            {
                "family": group.family,
                "role": group.role,
                "mutants": group.mutants,
                "population": group.population,
                **scores_data(group.scores),
            }
            for group in results.groups
        ],
        "mutants": [result_data(result) for result in results.mutants],
        "graded": [result_data(result) for result in results.graded],
        "left_out": [
            {"id": item.id, "description": item.description, "reason": item.reason}
            for item in results.left_out
        ],
        "controls": [
            {"test_file": one.test_file, "control": one.control, "ok": one.ok, "detail": one.detail}
            for one in results.controls
        ],
        "baseline": [
            {
                "test": one.test.test,
                "round": one.round + 1,
                "repetition": one.repetition + 1,
                "outcome": one.test.outcome,
                "wall": one.test.wall,
                "simulated": one.test.simulated,
            }
            for one in results.tests
        ],
        "sample": drawing_data(results.drawing),
        "since": to_data(results.since),
        "budget": to_data(results.budget),
        "flaky": list(results.flaky.tests),
        "verification": _verification(results.verification),
        "repeats": repeats_data(results.repeats),
        "shard": _shard(results.shard),
        "set_aside": list(results.set_aside),
        "altered": list(results.altered),
    }


def mutant_data(mutant: Mutant) -> dict[str, Any]:
    """One mutant as planned."""
    span = mutant.site.span
    return {
        "id": mutant.id,
        "number": mutant.number,
        "operator": mutant.operator,
        "variant": mutant.variant,
        "family": mutant.family,
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
        "operation": mutant.operation,
        "pattern": mutant.pattern,
        "quantity": mutant.quantity,
        "description": mutant.description,
        "magnitude": mutant.magnitude,
        "unit": mutant.unit,
        "direction": mutant.direction or None,
        "ladder": mutant.ladder or None,
        "moment": mutant.moment.text if mutant.moment is not None else None,
    }


def result_data(result: MutantResult) -> dict[str, Any]:
    """One mutant with what became of it."""
    return {
        **mutant_data(result.mutant),
        "meaning": _meaning(result.quantity),
        "rounds": [_round_data(number, one) for number, one in enumerate(result.rounds, start=1)],
        "kill_rate": _kill_rate(result.kill_rate),
        "survivor": result.is_survivor,
        "indistinguishable": result.indistinguishable,
        "distance": result.distance if result.is_survivor else None,
        "worst": result.worst if result.is_survivor else None,
        "why": result.why,
        "earlier": result.earlier,
        "outdated": result.outdated,
    }


def score_data(score: Score) -> dict[str, Any]:
    """A score with its counts."""
    return {
        "score": score.score,
        "check_score": score.check_score,
        "killed": score.killed,
        "valid": score.valid,
        "by_check": score.by_check,
        "timeouts": score.timeouts,
        "counts": {verdict.value: score.counts.get(verdict, 0) for verdict in Verdict},
    }


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
        "rounds": [
            {"round": number, **score_data(score)} for number, score in enumerate(scores.rounds, start=1)
        ],
    }


def replayed_data(mutant: Mutant, rounds: Iterable[Replayed]) -> dict[str, Any]:
    """One mutant that was run again, beside its outcomes in the journal."""
    return {
        "id": mutant.id,
        "number": mutant.number,
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


def _shard(shard: ShardOf | None) -> dict[str, Any] | None:
    if shard is None:
        return None
    return {"number": shard.number, "of": shard.of, "mutants": list(shard.mutants)}


def _verification(found: Verification | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {
        "wanted": found.wanted,
        "checked": found.checked,
        "agreed": found.agreed,
        "disagreements": [
            {
                "id": one.mutant,
                "number": one.number,
                "round": one.round + 1,
                "first": one.first,
                "second": one.second,
            }
            for one in found.disagreements
        ],
    }


def repeats_data(repeats: Repeats) -> dict[str, Any]:
    """What was run once more, and what that says about the others."""
    return {
        "doubted": _stratum(repeats.doubted),
        "others": _stratum(repeats.others),
        "certain": repeats.certain,
        "survivors": _stratum(repeats.survivors),
        "false_kills": _estimate(false_kills(repeats)),
        "false_survivors": _estimate(false_survivors(repeats)),
    }


def _stratum(stratum: Repeated) -> dict[str, int]:
    return {"outcomes": stratum.outcomes, "repeated": stratum.repeated, "changed": stratum.changed}


def _estimate(found: Estimate | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {
        "expected": found.expected,
        "low": found.low,
        "high": found.high,
        "level": found.level,
        "known": found.known,
        "unknown": found.unknown,
    }


def _round_data(number: int, outcome: Outcome | None) -> dict[str, Any]:
    if outcome is None:
        return {"round": number, "verdict": None}
    return {
        "round": number,
        "verdict": outcome.verdict.value,
        "by": outcome.by.value if outcome.by is not None else None,
        "test": outcome.test,
        "exception": outcome.exception,
        "message": outcome.message,
        "place": outcome.place,
        "hits": outcome.hits,
        "acted": outcome.acted,
        "away": dict(outcome.away),
        "example": list(outcome.example) if outcome.example is not None else None,
        "tests": outcome.tests,
        "wall": outcome.wall,
        "simulated": outcome.simulated,
        "indistinguishable": outcome.indistinguishable,
        "distance": outcome.distance,
        "divergence": list(outcome.divergence),
        "way": outcome.way,
        "gaps": list(outcome.gaps),
        "compared": to_data(outcome.compared) if outcome.compared is not None else None,
        "engine": outcome.engine,
        "stuck": outcome.stuck,
        "repeats": outcome.repeats,
        "beside": outcome.beside,
        "figures": [{**to_data(one), "is_better": one.is_better} for one in outcome.figures],
        "looked": [to_data(one) for one in outcome.looked],
        "diverged": [{**to_data(one), "worst": one.worst} for one in outcome.diverged],
    }


def _kill_rate(rate: KillRate) -> dict[str, Any]:
    return {
        "killed": rate.killed,
        "valid": rate.valid,
        "rate": rate.rate,
        "interval": interval_data(rate.interval),
    }


def drawing_data(drawing: Drawing | None) -> dict[str, Any] | None:
    """How the mutants were drawn, or None if all of them were run."""
    if drawing is None:
        return None
    return {"size": drawing.sample, "selected": drawing.selected}


def interval_data(interval: Interval | None) -> dict[str, float] | None:
    """An interval with its level, or None."""
    if interval is None:
        return None
    return {"low": interval.low, "high": interval.high, "level": interval.level}


def _meaning(quantity: Quantity | None) -> dict[str, Any] | None:
    if quantity is None:
        return None
    return {
        "kind": quantity.kind.value,
        "axis": quantity.axis,
        "unit": quantity.unit,
        "frame": quantity.frame,
        "mode": quantity.mode.value if quantity.mode is not None else None,
    }


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
