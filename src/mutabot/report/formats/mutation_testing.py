"""mutation-testing-report-schema, version 2: the JSON that Stryker's report page and dashboard show.

That schema has one status per mutant and no rounds: ``shaping.status`` says which, and the rounds stand in
``statusReason``. Outside the score stand there *RuntimeError*, *CompileError*, *Ignored* and *Pending*.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from mutabot.languages.registry import language_of
from mutabot.model import Mutant, Span, Verdict
from mutabot.report.document import dumps
from mutabot.report.format import Material, utf16
from mutabot.report.texts import ACCEPTED, NOT_RUN, also_text, next_step, reason_of, state_of
from mutabot.results.results import MutantResult, killing_tests

_SCHEMA_VERSION = "2.0"
#: in percent; what the page paints green and red. They are the schema's customary ones, and no limit of ours
_THRESHOLDS = {"high": 80, "low": 60}
#: our state to theirs. docs/reports.md has the reasons
_STATUS: Mapping[str, str] = {
    Verdict.KILLED: "Killed",
    Verdict.TIMEOUT: "Timeout",
    Verdict.SURVIVED: "Survived",
    Verdict.NOT_COVERED: "NoCoverage",
    Verdict.INVALID: "CompileError",  # it is no program, or no command
    Verdict.REFUSED: "RuntimeError",  # it ran, and the robot answered with an error that no test is about
    Verdict.GUARDED: "RuntimeError",  # the same, and what answered was the user's own guard
    Verdict.ERROR: "RuntimeError",  # the run failed, and no test did
    Verdict.NO_EFFECT: "Ignored",  # it ran and was the original: nothing was there to judge
    Verdict.UNSTABLE: "Ignored",  # it ran, and what came of it is not believed
    ACCEPTED: "Ignored",  # reviewed: its reason says why it may survive
    NOT_RUN: "Pending",  # it was planned, and has not been run yet
}


def make(material: Material) -> str:
    """Return the report."""
    campaign = material.campaign
    return dumps(
        {
            "schemaVersion": _SCHEMA_VERSION,
            "thresholds": _THRESHOLDS,
            "framework": {"name": "Mutabot", "version": str(campaign.meta.get("mutabot", ""))},
            "config": {
                **{key: campaign.meta.get(key) for key in ("families", "rounds", "seed", "engine")},
                "state": campaign.state,
                "outcomes": {"known": campaign.done, "planned": campaign.planned},
                "leftOut": dict(Counter(item.reason for item in campaign.left_out)),
            },
            "files": _files(material),
            "testFiles": _test_files(material),
        }
    )


def _files(material: Material) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for result in material.campaign.mutants:
        file = result.mutant.site.span.file
        entry = found.setdefault(
            material.path(file),
            {
                "language": language_of(file) or "text",
                "source": material.campaign.source(file) or "",
                "mutants": [],
            },
        )
        entry["mutants"].append(_mutant(result, material))
    return found


def _mutant(result: MutantResult, material: Material) -> dict[str, Any]:
    mutant = result.mutant
    killed_by = dict.fromkeys(test for outcome in result.outcomes for test, _ in killing_tests(outcome))
    return {
        "id": mutant.id,
        "mutatorName": mutant.operator,
        "description": f"{mutant.description}{also_text(mutant.site)}",
        "replacement": _replacement(mutant, material),
        "location": _location(mutant.site.span, material),
        "status": _STATUS[state_of(result)],
        "statusReason": "\n".join(filter(None, [reason_of(result), next_step(result)])),
        "coveredBy": [*dict.fromkeys([*material.campaign.reached_by(mutant), *killed_by])],
        "killedBy": [*killed_by],
        "testsCompleted": max((outcome.tests for outcome in result.outcomes), default=0),
        "duration": 1000 * sum(outcome.wall for outcome in result.outcomes),
    }


def _replacement(mutant: Mutant, material: Material) -> str:
    """Return the new text of a mutant of program text; the description of any other mutant."""
    text = material.place(mutant.site.span).text
    before, arrow, after = mutant.description.partition(" → ")
    return after if arrow and before == text else mutant.description


def _location(span: Span, material: Material) -> dict[str, Any]:
    place = material.place(span, utf16)
    end_column = place.end_column or place.column + 1
    return {
        "start": {"line": place.line, "column": place.column},
        "end": {"line": place.end_line, "column": end_column},
    }


def _test_files(material: Material) -> dict[str, Any]:
    """Return all known tests by their files."""
    found: dict[str, Any] = {}
    for test in material.campaign.tests:
        file, _, name = test.partition("::")
        tests = found.setdefault(material.path(file), {"tests": []})["tests"]
        tests.append({"id": test, "name": name or test})
    return found
