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
    return next(one for one in found if one[key] == samples.SKIP.id)


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
    one = of_skip(data["mutants"])
    assert (one["status"], one["survivor"], one["accepted"]["why"]) == ("accepted", False, WHY)
    assert [each["accepted"] for each in data["groups"]] == [1, 0]
    assert [each["id"] for each in data["accepting"]["survivors"]] == [samples.SKIP.id]
    assert data["accepting"]["without_effect"] == ACCEPTED["unmatched"]


def test_code_scanning_suppresses_them(campaign: mutabot.StoredCampaign) -> None:
    (run,) = json.loads(made("sarif", campaign))["runs"]
    found = {one["properties"]["mutant"]: one.get("suppressions") for one in run["results"]}
    (one,) = found.pop(samples.SKIP.id)
    assert (one["kind"], one["status"]) == ("external", "accepted")
    assert one["justification"].startswith(WHY)
    assert set(found.values()) == {None}


def test_junit_skips_them(campaign: mutabot.StoredCampaign) -> None:
    case = next(
        one for one in Xml.fromstring(made("junit", campaign)).iter("testcase")
        if one.get("name") == samples.SKIP.id
    )  # fmt: skip
    assert [child.tag for child in case] == ["skipped"]
    assert WHY in (case[0].get("message") or "")


def test_the_mutation_testing_elements_ignore_them_with_the_reason(campaign: mutabot.StoredCampaign) -> None:
    files = json.loads(made("mutation-testing", campaign))["files"]
    one = of_skip(files["mission.py"]["mutants"])
    assert one["status"] == "Ignored"
    assert f"accepted on 2026-01-31: {WHY}" in one["statusReason"].splitlines()


def test_github_annotates_none_of_them_and_says_how_many(campaign: mutabot.StoredCampaign) -> None:
    lines = made("github", campaign).splitlines()
    assert not any(f"Survivor {samples.SKIP.number}" in line for line in lines)
    assert "1 accepted survivor is not shown" in lines[-1]


def test_tables_give_the_reason_beside_the_verdict(campaign: mutabot.StoredCampaign) -> None:
    rows = list(csv.DictReader(io.StringIO(made("csv", campaign))))
    accepted = {(one["mutant"], one["verdict"]) for one in rows if one["accepted"] == WHY}
    assert accepted == {(samples.SKIP.id, "survived")}
    assert {row["accepted"] for row in campaign.rows()} == {None, WHY}


def test_pages_have_a_state_for_them(campaign: mutabot.StoredCampaign) -> None:
    data = campaign_data(campaign, "x")
    one = of_skip([dict(zip(data["columns"], row, strict=True)) for row in data["mutants"]])
    assert one["status"] == "accepted"
    assert one["why"].startswith(f"accepted on 2026-01-31: {WHY}; ")


def test_a_limit_of_the_score_counts_them_no_more(tmp_path: Path) -> None:
    outcomes = tuple(one for one in samples.OUTCOMES if one.mutant in (samples.REVERSE.id, samples.SKIP.id))
    mutants = (samples.REVERSE, samples.SKIP)
    before = stored(tmp_path, outcomes=outcomes, mutants=mutants)
    after = stored(tmp_path, outcomes=outcomes, mutants=mutants, accepted=ACCEPTED)
    assert [decide(one, min_score=1.0).exit_code for one in (before, after)] == [1, 0]


def test_a_campaign_of_accepted_mutants_alone_says_so(tmp_path: Path) -> None:
    outcomes = tuple(one for one in samples.OUTCOMES if one.mutant == samples.SKIP.id)
    found = decide(stored(tmp_path, outcomes=outcomes, mutants=(samples.SKIP,), accepted=ACCEPTED))
    assert found.exit_code == 3
    assert found.lines == ("no mutant is left to judge: 1 of 1 are accepted",)
