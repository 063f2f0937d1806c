"""Stryker's report format: one honest status per mutant, and places as JavaScript counts them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import mutabot
from mutabot.model import By, Mutant, Outcome, Verdict
from report.material import made, stored
from results import samples


@pytest.fixture
def campaign(tmp_path: Path) -> mutabot.StoredCampaign:
    return stored(tmp_path)


def report(campaign: mutabot.StoredCampaign) -> Any:
    return json.loads(made("mutation-testing", campaign))


def mutants(data: Any) -> Iterator[Any]:
    for file in data["files"].values():
        yield from file["mutants"]


def found_in(campaign: mutabot.StoredCampaign, mutant: Mutant) -> Any:
    return next(found for found in mutants(report(campaign)) if found["id"] == mutant.id)


STATUSES = {
    Verdict.KILLED: "Killed",
    Verdict.TIMEOUT: "Timeout",
    Verdict.SURVIVED: "Survived",
    Verdict.NOT_COVERED: "NoCoverage",
    Verdict.INVALID: "CompileError",
    Verdict.REFUSED: "RuntimeError",
    Verdict.GUARDED: "RuntimeError",
    Verdict.ERROR: "RuntimeError",
    Verdict.NO_EFFECT: "Ignored",
    Verdict.UNSTABLE: "Ignored",
}


@pytest.mark.parametrize("verdict", Verdict)
def test_every_verdict_has_its_status_and_the_reason(tmp_path: Path, verdict: Verdict) -> None:
    ends = tuple(Outcome(samples.SKIP.id, round, verdict, message="because of this") for round in range(2))
    found = found_in(stored(tmp_path, outcomes=ends), samples.SKIP)
    assert found["status"] == STATUSES[verdict]
    assert found["statusReason"].startswith(f"{verdict} in rounds 1 and 2")
    if not {verdict} & {Verdict.SURVIVED, Verdict.NOT_COVERED}:
        assert "because of this" in found["statusReason"]


def test_a_mutant_that_has_not_been_run_is_pending(tmp_path: Path) -> None:
    found = found_in(stored(tmp_path, outcomes=(), finish="interrupted"), samples.SKIP)
    assert (found["status"], found["statusReason"]) == ("Pending", "not run in rounds 1 and 2")


def test_rounds_that_differ_are_all_reported(campaign: mutabot.StoredCampaign) -> None:
    found = found_in(campaign, samples.NEGATE)
    assert found["status"] == "Survived"
    assert found["statusReason"].startswith("survived in round 1, killed by check in round 2\n")
    assert f"round 2: {samples.TEST}: assert False" in found["statusReason"]


def test_a_survivor_is_no_less_one_because_nothing_differed(tmp_path: Path) -> None:
    end = Outcome(samples.SKIP.id, 0, Verdict.SURVIVED, indistinguishable=True)
    found = found_in(stored(tmp_path, outcomes=(end,)), samples.SKIP)
    assert found["status"] == "Survived"
    assert "indistinguishable" in found["statusReason"]


def test_places_count_utf_16_from_1(campaign: mutabot.StoredCampaign) -> None:
    # naïve = "größe"; is five bytes longer than it has characters
    assert found_in(campaign, samples.BY_TO)["location"] == {
        "start": {"line": 4, "column": 22},
        "end": {"line": 4, "column": 42},
    }
    wide = replace(campaign, sources={"mission.py": "\n\n\n" + "😀" * 6 + "go(1)" * 5})
    assert found_in(wide, samples.BY_TO)["location"]["start"] == {"line": 4, "column": 13}


def test_the_text_at_a_place_is_the_call(campaign: mutabot.StoredCampaign) -> None:
    data = report(campaign)
    lines = data["files"]["mission.py"]["source"].split("\n")
    place = found_in(campaign, samples.REVERSE)["location"]
    line = lines[place["start"]["line"] - 1]
    assert line[place["start"]["column"] - 1 : place["end"]["column"] - 1].startswith("arm.move_by(dx=0.2")


def test_tests_that_are_named_are_defined_and_defined_once(campaign: mutabot.StoredCampaign) -> None:
    data = report(campaign)
    defined = [test["id"] for file in data["testFiles"].values() for test in file["tests"]]
    assert sorted(defined) == [f"{'tests/test_b.py'}::test_b", samples.TEST]
    for mutant in mutants(data):
        assert set(mutant["killedBy"]) <= set(mutant["coveredBy"]) <= set(defined)
    found = found_in(campaign, samples.REVERSE)
    assert (found["killedBy"], found["coveredBy"]) == ([samples.TEST], defined)
    assert found_in(campaign, samples.SKIP)["coveredBy"] == ["tests/test_b.py::test_b"]
    assert found_in(campaign, samples.BY_TO)["killedBy"] == [samples.TEST]


def test_times_are_milliseconds_over_all_rounds(campaign: mutabot.StoredCampaign) -> None:
    assert found_in(campaign, samples.REVERSE)["duration"] == 1500


def test_a_mutant_of_the_program_text_has_the_new_text(tmp_path: Path) -> None:
    span = replace(samples.MOVE.span, column=16, end_column=22)
    site = replace(samples.MOVE, span=span, text="dx=0.2")
    mutant = replace(
        samples.REVERSE, family="conventional", operation="", quantity=None, site=site,
        description="dx=0.2 → dx=-0.2",
    )  # fmt: skip
    end = Outcome(mutant.id, 0, Verdict.KILLED, By.CHECK)
    campaign = stored(tmp_path, mutants=(mutant, samples.SKIP), outcomes=(end,))
    assert found_in(campaign, mutant)["replacement"] == "dx=-0.2"
    assert found_in(campaign, samples.SKIP)["replacement"] == "gripper.command: do nothing"


def test_nothing_names_the_machine(campaign: mutabot.StoredCampaign) -> None:
    data = report(campaign)
    assert not {"projectRoot", "system"} & set(data)
    assert "root" not in data["config"]
    assert data["framework"]["name"] == "Mutabot"
