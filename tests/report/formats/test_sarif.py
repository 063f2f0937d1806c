"""SARIF: a result per survivor, with a rule that helps and a name that lasts."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import mutabot
from mutabot.model import Outcome, Verdict
from report.material import made, stored, with_text
from results import samples


@pytest.fixture
def campaign(tmp_path: Path) -> mutabot.StoredCampaign:
    return stored(tmp_path)


def run(campaign: mutabot.StoredCampaign) -> Any:
    (found,) = json.loads(made("sarif", campaign))["runs"]
    return found


def test_there_is_a_result_for_every_survivor_the_worst_first(campaign: mutabot.StoredCampaign) -> None:
    found = run(campaign)["results"]
    assert [finding["properties"]["mutant"] for finding in found] == [
        samples.SKIP.id, samples.NOISE.id, samples.NEGATE.id,
    ]  # fmt: skip
    assert [finding["level"] for finding in found] == ["error", "note", "note"]


def test_the_level_says_how_much_a_survivor_changed(tmp_path: Path) -> None:
    ends = (
        Outcome(samples.SKIP.id, 0, Verdict.SURVIVED, indistinguishable=False, divergence=("box: 1",)),
        Outcome(samples.REVERSE.id, 0, Verdict.SURVIVED, gaps=("no probe",)),
        Outcome(samples.BY_TO.id, 0, Verdict.NOT_COVERED),
        Outcome(samples.NEGATE.id, 0, Verdict.SURVIVED, indistinguishable=True),
    )
    found = run(stored(tmp_path, outcomes=ends))["results"]
    levels = {finding["properties"]["mutant"]: finding["level"] for finding in found}
    assert levels == {
        samples.SKIP.id: "error",
        samples.REVERSE.id: "warning",
        samples.BY_TO.id: "note",
        samples.NEGATE.id: "note",
    }


def test_a_result_is_known_again_although_its_line_and_number_changed(
    campaign: mutabot.StoredCampaign, tmp_path: Path
) -> None:
    first = run(campaign)["results"][0]
    moved = replace(
        samples.SKIP,
        number=9,
        site=replace(samples.OPEN, span=replace(samples.OPEN.span, line=5, end_line=5)),
    )
    later = run(stored(tmp_path / "later", mutants=(moved,)))["results"][0]
    assert first["partialFingerprints"] == later["partialFingerprints"]
    assert first["locations"] != later["locations"]


def test_places_are_relative_to_the_repository_and_hold_their_text(campaign: mutabot.StoredCampaign) -> None:
    found = run(campaign)
    place = found["results"][0]["locations"][0]["physicalLocation"]
    assert place["artifactLocation"] == {"uri": "mission.py", "uriBaseId": "%SRCROOT%"}
    assert place["region"] == {
        "startLine": 2, "endLine": 2, "startColumn": 5, "endColumn": 23,
        "snippet": {"text": "gripper.command(0)"},
    }  # fmt: skip
    assert "%SRCROOT%" in found["originalUriBaseIds"]
    assert found["columnKind"] == "utf16CodeUnits"


def test_a_file_with_odd_letters_is_a_uri(campaign: mutabot.StoredCampaign) -> None:
    span = replace(samples.OPEN.span, file="größe 100%.py")
    mutant = replace(samples.SKIP, site=replace(samples.OPEN, span=span))
    (result, *_) = campaign.survivors
    odd = replace(campaign, mutants=(replace(result, mutant=mutant),))
    found = run(odd)["results"][0]["locations"][0]["physicalLocation"]
    assert found["artifactLocation"]["uri"] == "gr%C3%B6%C3%9Fe%20100%25.py"
    assert "snippet" not in found["region"]


def test_rules_help(campaign: mutabot.StoredCampaign) -> None:
    found = run(campaign)
    rules = found["tool"]["driver"]["rules"]
    for result in found["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
    texts = {rule["id"]: rule["help"]["text"] for rule in rules}
    assert texts["skip"].startswith("A command is not carried out.")
    assert "operator negate of family robot" in texts["negate"].lower()  # whose journal does not say more


def test_what_has_a_meaning_in_messages_is_escaped(campaign: mutabot.StoredCampaign) -> None:
    found = run(with_text(campaign, "{0} [link](1)"))["results"][0]
    assert "{{0}} [link] (1)" in found["message"]["text"]


def test_an_interrupted_campaign_is_no_success(tmp_path: Path) -> None:
    found = run(stored(tmp_path, outcomes=samples.OUTCOMES[:3], finish="interrupted"))["invocations"][0]
    assert found["executionSuccessful"] is False
    (note,) = found["toolExecutionNotifications"]
    assert note["message"]["text"] == "interrupted: 3 of 10 outcomes are known"


def test_a_rule_says_what_no_test_notices_and_a_result_what_to_do(campaign: mutabot.StoredCampaign) -> None:
    found = run(campaign)
    rules = {rule["id"]: rule["shortDescription"]["text"] for rule in found["tool"]["driver"]["rules"]}
    assert rules["skip"].startswith("A command is not carried out")
    assert rules["skip"].endswith(": no test notices it")
    texts = {finding["ruleId"]: finding["message"]["text"] for finding in found["results"]}
    assert "`mutabot suggest --only 2`" in texts["skip"]
    assert texts["noise"].endswith("Add a test that runs this line.")  # not covered
    assert "equivalent mutant" in texts["negate"]  # indistinguishable
