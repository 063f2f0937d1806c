"""Thresholds as JSON; docs/json.md describes it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

from mutabot.analysis.thresholds.demands import suggested
from mutabot.analysis.thresholds.ladders import Ladder, LadderRound, Step
from mutabot.analysis.thresholds.thresholds import Comparison, Floor, Thresholds
from mutabot.analysis.thresholds.words import line_of
from mutabot.model.graded import OFFSET
from mutabot.report.as_json import FORMAT, facts, interval_data


def thresholds_data(thresholds: Thresholds) -> dict[str, Any]:
    """Everything about the ladders of a campaign. Ends that are not bounded are null."""
    return {
        "format": FORMAT,
        "state": thresholds.state,
        "rounds": thresholds.rounds,
        "ladders": [ladder_data(one) for one in thresholds.all],
        "floors": [_floor(one) for one in thresholds.floors],
        **facts(thresholds, "runs exhaustive controls false_alarms most_violated"),
    }


def ladder_data(ladder: Ladder) -> dict[str, Any]:
    """One ladder."""
    mutant = ladder.mutant
    judged = not ladder.why_unjudged
    median = ladder.median if judged else None
    return {
        **facts(ladder, "id place name"),
        **facts(mutant.site.span, "file line function"),
        "call": mutant.site.text,
        "role": mutant.site.role.value,
        **facts(mutant, "quantity operator direction unit"),
        "magnitudes": list(ladder.sizes),
        "judged": judged,
        "why": ladder.why_unjudged or None,
        "text": line_of(ladder) if judged else None,
        "none_up_to": (ladder.none_up_to or None) if judged else None,
        "half_from": ladder.half_from if judged else None,
        "all_from": ladder.all_from if judged else None,
        "refused_from": ladder.refused_from if judged else None,
        "rounds_counted": len(ladder.counted),
        "median": None
        if median is None
        else {"above": median.low or None, "at_most": median.high, "level": median.level},
        "share_shown": ladder.share_shown if judged else None,
        "rounds": [_round(one) for one in ladder.rounds],
        "steps": [_step(one) for one in ladder.steps],
        "violations": [{"round": one.round + 1, **facts(one, "noticed missed")} for one in ladder.violations],
        "better": [{"round": one.round + 1, **facts(one, "magnitude text")} for one in ladder.better],
        "runs": ladder.runs,
    }


def compared_data(comparison: Comparison) -> dict[str, Any]:
    """Two campaigns beside each other."""
    mean = comparison.mean
    words = not comparison.why_no_words
    return {
        "format": FORMAT,
        "why_no_words": comparison.why_no_words or None,
        "mean": None if mean is None else {"steps": mean.mean, **facts(mean, "low high level")},
        "improved": comparison.has_improved,
        "ladders": [
            {
                "id": one.new.id,
                "change": one.change.value if words else None,
                "steps": list(one.steps),
                "old": ladder_data(one.old),
                "new": ladder_data(one.new),
            }
            for one in comparison.ladders
        ],
        **facts(comparison, "gone added"),
    }


def _round(one: LadderRound) -> dict[str, Any]:
    bracket = one.bracket
    return {
        "round": one.number + 1,
        "counts": one.counts,
        "why": one.why_out or None,
        "missed": bracket.low,
        "noticed": bracket.high,
        "refused": bracket.refused,
        "by": one.noticed_by,
        "above": one.above.value,
        "verdicts": [{"magnitude": size, "verdict": end.verdict.value} for size, end in one.outcomes.items()],
    }


def _step(step: Step) -> dict[str, Any]:
    return {
        **facts(step, "magnitude number noticed valid"),
        "interval": interval_data(step.interval),
        **facts(step, "by refused unknown"),
    }


def _floor(one: Floor) -> dict[str, Any]:
    return {
        "up": one.up.id,
        "down": one.down.id,
        "unit": one.up.unit,
        "blind": list(one.blind),
        "half_width": list(one.half_width),
        "bias": [
            {"round": pair.round + 1, "above": pair.bias[0], "at_most": pair.bias[1]} for pair in one.pairs
        ],
        "noise": one.noise,
        "below_noise": one.is_below_noise,
        "false_alarms": one.false_alarms,
        "text": one.text if one.is_below_noise else None,
    }


def suggested_toml(ladders: Sequence[Ladder], *, table: str) -> str:
    """A demand for each quantity and site, of which both directions are met.

    ``table`` is the name of the tables: ``tool.mutabot.demand``, or ``demand`` in a file of mutabot's own.
    Where none can be suggested, a comment says why.
    """
    found: dict[str, list[Ladder]] = {}
    for one in ladders:
        found.setdefault(f"{one.mutant.site.id} {one.pair_name} {one.unit}", []).append(one)
    blocks = ["\n".join(_block(both, table)) for both in found.values()]
    return "\n\n".join(blocks)


def _block(both: Sequence[Ladder], table: str) -> Iterator[str]:
    for one in both:
        yield f"# {one.place} {one.name}: {line_of(one)}"
    sizes = [suggested(one) for one in both]
    known = [size for size in sizes if size is not None]
    first = both[0]
    if len(known) < len(sizes):
        yield "# no demand: some round neither notices nor refuses it, or the ladder ends too soon"
        return
    yield f"[[{table}]]"
    yield f"site = {_toml_text(first.mutant.site.id)}"
    if first.mutant.quantity is not None:
        yield f"quantity = {_toml_text(first.mutant.quantity)}"
    if first.mutant.operator != OFFSET:
        yield f"operator = {_toml_text(first.mutant.operator)}"
    notice = f"{max(known):.12g} {first.unit or ''}"
    yield f"notice = {_toml_text(notice.strip())}"


def _toml_text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
