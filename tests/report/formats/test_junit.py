"""JUnit XML: what CI systems count is what the campaign says."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest

import mutabot
from mutabot.model import Outcome, Verdict
from report.material import made, stored
from results import samples


def xml(campaign: mutabot.StoredCampaign) -> Xml.Element:
    return Xml.fromstring(made("junit", campaign))


def test_suites_are_files_with_their_family_and_role(tmp_path: Path) -> None:
    root = xml(stored(tmp_path))
    assert [suite.attrib["name"] for suite in root] == [
        "mission.py · robot · program", "tests/sensors.py · robot · oracle",
    ]  # fmt: skip
    for suite in [root, *root]:
        cases = suite.findall(".//testcase")
        assert int(suite.attrib["tests"]) == len(cases)
        for count, element in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
            assert int(suite.attrib[count]) == len(suite.findall(f".//{element}"))


@pytest.mark.parametrize(
    ("verdict", "element"),
    [
        (Verdict.KILLED, None),
        (Verdict.TIMEOUT, None),
        (Verdict.SURVIVED, "failure"),
        (Verdict.NOT_COVERED, "failure"),
        (Verdict.ERROR, "error"),
        (Verdict.UNSTABLE, "error"),
        (Verdict.REFUSED, "skipped"),
        (Verdict.INVALID, "skipped"),
        (Verdict.NO_EFFECT, "skipped"),
    ],
)
def test_every_verdict_is_what_ci_systems_know(tmp_path: Path, verdict: Verdict, element: str | None) -> None:
    end = Outcome(samples.SKIP.id, 0, verdict, message="because of this")
    (case,) = xml(stored(tmp_path, mutants=(samples.SKIP,), outcomes=(end,))).findall(".//testcase")
    assert [child.tag for child in case] == [element or "system-out"]
    assert f"{verdict} in round 1" in (case[0].text or "")
    if element in ("error", "skipped"):
        assert "because of this" in case[0].attrib["message"]


def test_a_mutant_that_has_not_been_run_is_skipped(tmp_path: Path) -> None:
    root = xml(stored(tmp_path, outcomes=(), finish="interrupted"))
    assert root.attrib["name"] == "mutabot (interrupted)"
    assert root.attrib["skipped"] == "5"
    messages = [skipped.attrib["message"] for skipped in root.findall(".//skipped")]
    assert messages[1] == "gripper.command: do nothing: not run in rounds 1 and 2"


def test_a_case_is_named_by_the_id_and_says_where_it_is(tmp_path: Path) -> None:
    (case,) = xml(stored(tmp_path)).findall(".//testcase[@line='3']")
    assert case.attrib["name"] == samples.REVERSE.id
    assert (case.attrib["file"], case.attrib["time"]) == ("mission.py", "1.500")


def test_scores_are_properties(tmp_path: Path) -> None:
    ends = tuple(outcome for outcome in samples.OUTCOMES if outcome.mutant != samples.BY_TO.id)
    mutants = tuple(mutant for mutant in samples.MUTANTS if mutant.id != samples.BY_TO.id)
    root = xml(stored(tmp_path, mutants=mutants, outcomes=ends))
    found = {
        property_element.attrib["name"]: property_element.attrib["value"]
        for property_element in root[0].findall("properties/property")
    }
    assert found == {"score": "0.5000", "check_score": "0.2500"}


def test_a_survivor_names_its_operator_and_what_to_do_and_a_killed_mutant_no_step(tmp_path: Path) -> None:
    cases = {case.attrib["name"]: case for case in xml(stored(tmp_path)).findall(".//testcase")}
    survived, killed = (cases[mutant.id][0].text or "" for mutant in (samples.SKIP, samples.REVERSE))
    assert survived.startswith("mission.py:2: skip: ")
    assert "`mutabot suggest --only 2`" in survived.splitlines()[-1]
    assert "mutabot suggest" not in killed
