"""What a report says of a campaign as a whole, and its mutants as rows of a list."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from mutabot.analysis.chance import false_kills, false_survivors
from mutabot.analysis.results import MutantResult
from mutabot.analysis.score import Group, Score
from mutabot.analysis.statistics import Interval
from mutabot.analysis.stored.campaign import StoredCampaign
from mutabot.analysis.thresholds.words import line_of
from mutabot.analysis.unlooked import unlooked
from mutabot.border.codec import to_data
from mutabot.journal.records import Verification
from mutabot.model import By, Outcome
from mutabot.report.as_json import facts
from mutabot.report.format import place_of, utf16
from mutabot.report.status import status_of, why_alone
from mutabot.report.terminal.console import mark_of

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
        **facts(results, "state attempt done planned rounds"),
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
        "drawing": facts(results.drawing, "sample selected") if results.drawing is not None else None,
    }


def _group(group: Group) -> dict[str, Any]:
    scores, total = group.scores, group.scores.total
    return {
        **facts(group, "family role mutants population"),
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


class Rows:
    """Rows that name what they share by numbers.

    Attributes:
        files: paths of sources.
        tests: node ids of all tests that are known.
        sites: the tests that reach a site, as numbers, by the number of the site.
        columns: the names of the cells of a row.
        rows: one row per mutant.
    """

    def __init__(self, campaign: StoredCampaign) -> None:
        self._campaign = campaign
        self.files: list[str] = []
        named = (test for one in campaign.outcomes for test, _ in _killers(one))
        baseline = (one.test.test for one in campaign.results.tests)
        self.tests = list(dict.fromkeys([*baseline, *campaign.reaching.tests, *named]))
        self._tests = {name: number for number, name in enumerate(self.tests)}
        self._files: dict[str, int] = {}
        self._sites: dict[str, int] = {}
        self.sites: list[list[int]] = []
        made = [self._row(one) for one in campaign.mutants]
        self.columns = [*made[0]] if made else []
        self.rows = [[*one.values()] for one in made]

    def _row(self, result: MutantResult) -> dict[str, Any]:
        mutant, rate, status = result.mutant, result.kill_rate, status_of(result)
        span = mutant.site.span
        place = place_of(span, self._campaign.source(span.file), utf16)
        return {
            "number": mutant.number,
            "id": mutant.id,
            "file": self._file(span.file),
            "line": place.line,
            "column": place.column,
            "endLine": place.end_line,
            "endColumn": place.end_column,
            "function": span.function,
            **facts(mutant, "operation quantity"),
            "unit": result.quantity.unit if result.quantity is not None else None,
            **facts(mutant, "operator variant family"),
            "role": mutant.site.role.value,
            "description": mutant.description,
            "ends": "".join(mark_of(one).letter for one in result.rounds),
            "status": status.value if status is not None else "not run",
            **facts(rate, "killed valid"),
            **facts(result, "worst indistinguishable"),
            "why": why_alone(result),
            "site": self._site(result),
            "kills": self._kills(result),
            "earlier": result.earlier or result.outdated,
            "drawn": _drawn(result) if result.mutant.operator in self._campaign.draws else None,
        }

    def _file(self, file: str) -> int:
        if file not in self._files:
            self._files[file] = len(self.files)
            self.files.append(file)
        return self._files[file]

    def _site(self, result: MutantResult) -> int:
        """The number of the site, and the tests that reach it."""
        key = result.mutant.site.id
        if key not in self._sites:
            self._sites[key] = len(self.sites)
            self.sites.append([self._tests[test] for test in self._campaign.reached_by(result.mutant)])
        return self._sites[key]

    def _kills(self, result: MutantResult) -> list[list[int]]:
        """The tests that are known to notice it: number, in how many rounds, in how many by a check."""
        found: dict[int, list[int]] = {}
        for outcome in result.outcomes:
            for test, by in dict(_killers(outcome)).items():
                counts = found.setdefault(self._tests[test], [0, 0])
                counts[0] += 1
                counts[1] += by is By.CHECK
        return [[test, *counts] for test, counts in found.items()]


def _killers(outcome: Outcome) -> list[tuple[str, By | None]]:
    """The tests that noticed a mutant, as far as they are known."""
    if not outcome.verdict.is_killed:
        return []
    first = [(outcome.test, outcome.by)] if outcome.test is not None else []
    return [*((one.test, one.by) for one in outcome.kills), *first]


def _drawn(result: MutantResult) -> Sequence[Sequence[Any]]:
    """What was drawn where it first acted, per round: the round, the value before, and after."""
    found = ((number, one.example) for number, one in enumerate(result.rounds) if one is not None)
    pairs = [(number, *pair) for number, pair in found if pair is not None and len(pair) == 2]
    return [one for one in pairs if all(isinstance(value, int | float) for value in one[1:])]
