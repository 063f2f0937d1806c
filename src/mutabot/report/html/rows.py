"""The mutants of a campaign as rows of a list, of which the page makes list, source, tests and operators."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mutabot.analysis.results import MutantResult
from mutabot.analysis.stored.campaign import StoredCampaign
from mutabot.model import By, Outcome, Verdict
from mutabot.report.shaping.places import place_of, utf16
from mutabot.report.shaping.status import status_of, why_alone

#: one letter per round, as on the terminal
_LETTERS = {
    Verdict.SURVIVED: "S",
    Verdict.NOT_COVERED: "N",
    Verdict.TIMEOUT: "T",
    Verdict.REFUSED: "R",
    Verdict.INVALID: "I",
    Verdict.NO_EFFECT: "=",
    Verdict.UNSTABLE: "U",
    Verdict.ERROR: "E",
}


def letter_of(outcome: Outcome | None) -> str:
    """The letter of an outcome; a dot where it has not been run."""
    if outcome is None:
        return "·"
    if outcome.verdict is Verdict.KILLED:
        return "C" if outcome.by is By.CHECK else "X"
    return _LETTERS[outcome.verdict]


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
            "operation": mutant.operation,
            "quantity": mutant.quantity,
            "unit": result.quantity.unit if result.quantity is not None else None,
            "operator": mutant.operator,
            "variant": mutant.variant,
            "family": mutant.family,
            "role": mutant.site.role.value,
            "description": mutant.description,
            "ends": "".join(map(letter_of, result.rounds)),
            "status": status.value if status is not None else "not run",
            "killed": rate.killed,
            "valid": rate.valid,
            "worst": result.worst,
            "indistinguishable": result.indistinguishable,
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
