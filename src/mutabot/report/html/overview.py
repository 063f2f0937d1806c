"""What a report says of a campaign as a whole."""

from __future__ import annotations

from collections import Counter
from typing import Any

from mutabot.analysis.chance import false_kills, false_survivors
from mutabot.analysis.score import Group, Score
from mutabot.analysis.statistics import Interval
from mutabot.analysis.stored.campaign import StoredCampaign
from mutabot.analysis.thresholds.words import line_of
from mutabot.analysis.unlooked import unlooked
from mutabot.border.codec import to_data
from mutabot.journal.records import Verification

from .rows import Rows

#: items of a list of what was left out, per reason
_ITEMS = 50
#: lines of ladders; `mutabot thresholds` has all
_LADDERS = 200
_META = ("mutabot", "python", "versions", "seed", "engine", "families", "started", "seconds")


def campaign_data(campaign: StoredCampaign, name: str) -> dict[str, Any]:
    """All of it but sources and the pages of mutants.

    Args:
        name: what the project is called.
    """
    results, rows = campaign.results, Rows(campaign)
    return {
        "name": name,
        "state": results.state,
        "attempt": results.attempt,
        "done": results.done,
        "planned": results.planned,
        "rounds": results.rounds,
        "meta": {key: results.meta[key] for key in _META if key in results.meta},
        "groups": [_group(one) for one in results.groups],
        "operators": dict(campaign.operators),
        "files": rows.files,
        "tests": rows.tests,
        "baseline": _baseline(campaign, rows.tests),
        "sites": rows.sites,
        "columns": rows.columns,
        "mutants": rows.rows,
        "unlooked": [
            [*one.places[:3], one.operation, one.quantity, one.text] for one in unlooked(results.mutants)
        ],
        "ladders": [
            [f"{one.place} {one.name}", line_of(one)] for one in campaign.thresholds.ladders[:_LADDERS]
        ],
        "leftOut": _left_out(campaign),
        "flaky": results.flaky.tests,
        "controls": [[one.test_file, one.control, one.ok, one.detail] for one in results.controls],
        "verification": _verification(results.verification),
        "repeats": {
            "repeats": to_data(results.repeats),
            "falseKills": _chance(false_kills(results.repeats)),
            "falseSurvivors": _chance(false_survivors(results.repeats)),
        },
        "drawing": _drawing(campaign),
    }


def _group(group: Group) -> dict[str, Any]:
    scores, total = group.scores, group.scores.total
    return {
        "family": group.family,
        "role": group.role,
        "mutants": group.mutants,
        "population": group.population,
        "score": scores.mean,
        "check": scores.mean_check,
        "interval": _ends(scores.interval),
        "checkInterval": _ends(scores.check_interval),
        "sampleInterval": _ends(scores.sample_interval),
        "killed": total.killed,
        "valid": total.valid,
        "byCheck": total.by_check,
        "counts": [[verdict.value, count] for verdict, count in total.counts.items()],
        "rounds": [_score(one) for one in scores.rounds],
    }


def _score(score: Score) -> list[Any]:
    return [score.score, score.check_score, score.killed, score.valid]


def _ends(interval: Interval | None) -> list[float] | None:
    return [interval.low, interval.high] if interval is not None else None


def _baseline(campaign: StoredCampaign, tests: list[str]) -> list[list[Any]]:
    """Per test: its outcomes on the original that occurred, and its simulated seconds."""
    found: dict[str, list[Any]] = {name: [[], None] for name in tests}
    for one in campaign.results.tests:
        ends, seconds = found[one.test.test]
        if one.test.outcome not in ends:
            ends.append(one.test.outcome)
        found[one.test.test][1] = seconds if one.test.simulated is None else one.test.simulated
    return list(found.values())


def _left_out(campaign: StoredCampaign) -> list[list[Any]]:
    left_out = campaign.results.left_out
    reasons = Counter(one.reason for one in left_out)
    return [
        [reason, count, [[one.id, one.description] for one in left_out if one.reason == reason][:_ITEMS]]
        for reason, count in reasons.most_common()
    ]


def _verification(found: Verification | None) -> dict[str, Any] | None:
    if found is None:
        return None
    told = [[one.number, one.round, one.first, one.second] for one in found.disagreements]
    return {"checked": found.checked, "wanted": found.wanted, "disagreements": told}


def _chance(found: Any) -> list[float] | None:
    return [found.expected, found.low, found.high, found.known] if found is not None else None


def _drawing(campaign: StoredCampaign) -> dict[str, Any] | None:
    found = campaign.results.drawing
    if found is None:
        return None
    return {"sample": found.sample, "selected": found.selected}
