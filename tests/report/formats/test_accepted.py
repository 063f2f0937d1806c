"""An accepted survivor in every report: no survivor any more, and counted by itself with its reason."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Xml

import pytest

import mutabot
from mutabot.report.document import document
from mutabot.report.html.folder import campaign_data
from mutabot.report.terminal.campaign import print_summary
from mutabot.report.terminal.console import make_console
from mutabot.results.gate import decide
from report.material import made, stored
from results import samples

WHY = "the gripper is open already"
ACCEPTED = {
    "mutants": {samples.SKIP.id: {"why": WHY, "source": "mutabot-accepted.toml:4", "date": "2026-01-31"}},
    "unmatched": ["mutabot-accepted.toml:9: no mutant is x: the decision has no effect"],
}


@pytest.fixture
def campaign(tmp_path: Path) -> mutabot.StoredCampaign:
    return stored(tmp_path, accepted=ACCEPTED)


def of_skip(found: list[Any], key: str = "id") -> Any:
    return next(entry for entry in found if entry[key] == samples.SKIP.id)


def test_the_terminal_says_how_many_are_accepted(campaign: mutabot.StoredCampaign) -> None:
    text = io.StringIO()
    print_summary(make_console(text, width=120), campaign)
    assert "\n1 survivor accepted, in no score\n" in text.getvalue()
    assert "gripper.command: do nothing" not in text.getvalue()
    assert ACCEPTED["unmatched"][0] in " ".join(text.getvalue().split())


def test_markdown_gives_the_reason(campaign: mutabot.StoredCampaign) -> None:
    assert f"accepted on 2026-01-31: {WHY}" in made("markdown", campaign)


def test_the_results_document_counts_them(campaign: mutabot.StoredCampaign) -> None:
    data = document(campaign)
    skip = of_skip(data["mutants"])
    assert (skip["status"], skip["survivor"], skip["accepted"]["why"]) == ("accepted", False, WHY)
    assert [each["accepted"] for each in data["groups"]] == [1, 0]
    assert [each["id"] for each in data["accepting"]["survivors"]] == [samples.SKIP.id]
    assert data["accepting"]["without_effect"] == ACCEPTED["unmatched"]


def test_code_scanning_suppresses_them(campaign: mutabot.StoredCampaign) -> None:
    (run,) = json.loads(made("sarif", campaign))["runs"]
    found = {finding["properties"]["mutant"]: finding.get("suppressions") for finding in run["results"]}
    (suppression,) = found.pop(samples.SKIP.id)
    assert (suppression["kind"], suppression["status"]) == ("external", "accepted")
    assert suppression["justification"].startswith(WHY)
    assert set(found.values()) == {None}
    assert of_skip([{**result["properties"], "id": result["properties"]["mutant"], **result}
                    for result in run["results"]])["level"] == "note"  # fmt: skip


def test_junit_skips_them(campaign: mutabot.StoredCampaign) -> None:
    case = next(
        element for element in Xml.fromstring(made("junit", campaign)).iter("testcase")
        if element.get("name") == samples.SKIP.id
    )  # fmt: skip
    assert [child.tag for child in case] == ["skipped"]
    assert WHY in (case[0].get("message") or "")


def test_the_mutation_testing_elements_ignore_them_with_the_reason(campaign: mutabot.StoredCampaign) -> None:
    files = json.loads(made("mutation-testing", campaign))["files"]
    skip = of_skip(files["mission.py"]["mutants"])
    assert skip["status"] == "Ignored"
    assert f"accepted on 2026-01-31: {WHY}" in skip["statusReason"].splitlines()


def test_github_annotates_none_of_them_and_says_how_many(campaign: mutabot.StoredCampaign) -> None:
    lines = made("github", campaign).splitlines()
    assert not any(f"Survivor {samples.SKIP.number}" in line for line in lines)
    assert "1 accepted survivor is not shown" in lines[-1]


def test_tables_give_the_reason_beside_the_verdict(campaign: mutabot.StoredCampaign) -> None:
    rows = list(csv.DictReader(io.StringIO(made("csv", campaign))))
    accepted = {(row["mutant"], row["verdict"]) for row in rows if row["accepted"] == WHY}
    assert accepted == {(samples.SKIP.id, "survived")}
    assert {row["accepted"] for row in campaign.rows()} == {None, WHY}


def test_pages_have_a_state_for_them(campaign: mutabot.StoredCampaign) -> None:
    data = campaign_data(campaign, "x")
    skip = of_skip([dict(zip(data["columns"], row, strict=True)) for row in data["mutants"]])
    assert skip["status"] == "accepted"
    assert skip["why"].startswith(f"accepted on 2026-01-31: {WHY}; ")


def test_a_limit_of_the_score_counts_them_no_more(tmp_path: Path) -> None:
    outcomes = tuple(
        outcome for outcome in samples.OUTCOMES if outcome.mutant in (samples.REVERSE.id, samples.SKIP.id)
    )
    mutants = (samples.REVERSE, samples.SKIP)
    before = stored(tmp_path, outcomes=outcomes, mutants=mutants)
    after = stored(tmp_path, outcomes=outcomes, mutants=mutants, accepted=ACCEPTED)
    assert [decide(results, min_score=1.0).exit_code for results in (before, after)] == [1, 0]


def test_a_campaign_of_accepted_mutants_alone_says_so(tmp_path: Path) -> None:
    outcomes = tuple(outcome for outcome in samples.OUTCOMES if outcome.mutant == samples.SKIP.id)
    found = decide(stored(tmp_path, outcomes=outcomes, mutants=(samples.SKIP,), accepted=ACCEPTED))
    assert found.exit_code == 3
    assert found.lines == ("no mutant is left to judge: 1 of 1 are accepted",)
