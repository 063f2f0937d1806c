"""What holds for every format, whatever a campaign brings along."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Xml

import pytest

import schemas
from mutabot.errors import UsageError
from mutabot.model import By, Diverged, Outcome, Verdict
from mutabot.report.format import Material, format_of, names
from mutabot.report.texts import portable
from report.material import HOSTILE, ROOT, made, stored, with_text
from results import samples

validators = pytest.importorskip("jsonschema.validators", reason="requirements-reports.lock is not installed")

JSON = ["mutation-testing", "sarif"]


def check(name: str, text: str) -> Any:
    """The data of a report in JSON, strict and as its schema says."""
    data = json.loads(text, parse_constant=pytest.fail)
    if name in schemas.SOURCES:
        try:
            schema = schemas.schema(name)
        except schemas.NoSchemaError as error:
            pytest.skip(f"no schema of {name} here: {error}")
        validators.validator_for(schema)(schema).validate(data)
    return data


def test_a_format_is_a_file_and_has_its_name() -> None:
    assert names()
    files = [format_of(name).__module__.rpartition(".")[2] for name in names()]
    assert [file.replace("_", "-") for file in files] == names()


def test_an_unknown_format_is_named_with_the_nearest() -> None:
    with pytest.raises(UsageError, match="did you mean 'junit'"):
        format_of("junti")


@pytest.mark.parametrize("name", JSON)
@pytest.mark.parametrize("finish", ["complete", "interrupted"])
def test_json_is_as_the_published_schema_says(tmp_path: Path, name: str, finish: str) -> None:
    for number, outcomes in enumerate((samples.OUTCOMES, samples.OUTCOMES[:3], ())):
        campaign = stored(tmp_path / str(number), outcomes=outcomes, finish=finish)
        check(name, made(name, campaign))


@pytest.mark.parametrize("name", JSON)
def test_json_is_strict_whatever_texts_say(tmp_path: Path, name: str) -> None:
    campaign = stored(tmp_path)
    for text in HOSTILE:
        check(name, made(name, with_text(campaign, text)))


@pytest.mark.parametrize("name", JSON)
def test_numbers_that_json_cannot_hold_are_not_in_it(tmp_path: Path, name: str) -> None:
    campaign = stored(tmp_path)
    odd = [replace(outcome, way=float("nan"), distance=float("inf")) for outcome in samples.OUTCOMES]
    mutants = tuple(
        replace(mutant, rounds=tuple(odd[2 * index : 2 * index + 2]))
        for index, mutant in enumerate(campaign.mutants)
    )
    check(name, made(name, replace(campaign, mutants=mutants)))


@pytest.mark.parametrize("text", HOSTILE)
def test_xml_can_be_parsed_and_says_what_was_said(tmp_path: Path, text: str) -> None:
    campaign = with_text(stored(tmp_path), text)
    root = Xml.fromstring(made("junit", campaign))
    assert len(root.findall(".//testcase")) == len(samples.MUTANTS)
    message = " ".join(portable(campaign).mutants[1].why.split())
    (failure,) = root.findall(".//testcase[@line='2'][@file='mission.py']/failure")
    assert failure.attrib["message"].endswith(message)


@pytest.mark.parametrize("name", names())
def test_no_report_holds_a_control_character(tmp_path: Path, name: str) -> None:
    campaign = stored(tmp_path)
    control = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
    assert [text for text in HOSTILE if control.search(made(name, with_text(campaign, text)))] == []


@pytest.mark.parametrize("name", names())
def test_no_report_names_a_folder_of_the_machine(tmp_path: Path, name: str) -> None:
    told = f"{ROOT}/mission.py /home/me/robot/a.py file:///tmp/pytest-of-me/x.log /usr/lib/python3/json.py"
    campaign = with_text(stored(tmp_path), "safe")
    campaign = replace(
        campaign,
        state=f"OSError: {told}",
        mutants=tuple(
            replace(
                result,
                why=told,
                rounds=tuple(replace(each, message=told, place=told, test=f"{ROOT}/tests/a.py::b")
                             for each in result.rounds if each is not None),
            )
            for result in campaign.mutants
        ),
        meta={**campaign.meta, "root": ROOT},
    )  # fmt: skip
    text = format_of(name)(Material(portable(campaign)))
    data = text.encode() if isinstance(text, str) else text
    for part in (ROOT, "/home/me", "/tmp/", "/usr/lib", str(tmp_path)):
        assert part.encode() not in data, part


@pytest.mark.parametrize("name", ["mutation-testing", "sarif", "junit", "markdown", "github"])
def test_files_are_named_from_the_root_of_the_repository_on(tmp_path: Path, name: str) -> None:
    text = made(name, stored(tmp_path), prefix="cells/one")
    assert "cells/one/mission.py" in text
    assert "cells/one/tests/sensors.py" in text


@pytest.mark.parametrize("name", [name for name in names() if name != "csv"])
def test_a_campaign_that_was_interrupted_says_so(tmp_path: Path, name: str) -> None:
    campaign = stored(tmp_path, outcomes=samples.OUTCOMES[:3], finish="interrupted")
    assert re.search("interrupted|not complete", made(name, campaign))


@pytest.mark.parametrize("name", ["github", "junit", "lines", "markdown", "mutation-testing", "sarif"])
def test_a_story_stands_beside_the_test_and_the_round_in_which_it_happened(tmp_path: Path, name: str) -> None:
    there = Diverged("tests/test_a.py::test_far", 5.0, "", "box ended 0.3 m off")
    outcomes = tuple(
        replace(outcome, diverged=(there,))
        if (outcome.mutant, outcome.round) == (samples.SKIP.id, 1)
        else outcome
        for outcome in samples.OUTCOMES
    )
    text = made(name, stored(tmp_path, outcomes=outcomes)).replace("\\_", "_")
    assert set(re.findall(r"box ended 0\.3 m off(.{0,23})", text)) == {" (in test_far, round 2)"}


@pytest.mark.parametrize("name", names())
def test_a_mutant_that_only_some_rounds_reach_and_kill_is_in_every_format(tmp_path: Path, name: str) -> None:
    verdicts = (Verdict.NOT_COVERED, Verdict.KILLED)
    ends = tuple(
        Outcome(samples.REVERSE.id, number, verdict, By.CHECK if verdict.is_killed else None, message="why")
        for number, verdict in enumerate(verdicts)
    )
    assert made(name, stored(tmp_path, outcomes=ends))
