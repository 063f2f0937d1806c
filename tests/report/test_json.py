"""The JSON report: valid JSON with what docs/json.md says."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from mutabot.errors import ExtensionError
from mutabot.extensions import ExtensionPart
from mutabot.journal.journal import Journal
from mutabot.journal.records import Untested
from mutabot.model import Diverged, Outcome, Verdict
from mutabot.model.world_difference import Apart
from mutabot.report.document import document, dumps
from mutabot.report.terminal.campaign import plan_data
from mutabot.results.results import Results, read_results
from results import samples

SECOND_LOOK: dict[str, Any] = {
    "verification": {
        "wanted": 20,
        "checked": 10,
        "disagreements": [
            {
                "mutant": samples.SKIP.id,
                "number": 2,
                "round": 1,
                "first": "survived",
                "second": "killed by check",
            }
        ],
    },
    "flaky": {"tests": ["test_a in round 1: failed and passed in equal runs"], "known": 4},
    "repeats": {"doubted": {"outcomes": 4, "repeated": 4, "changed": 1}, "survivors": {"outcomes": 9}},
}
DRAWING = {
    "drawing": {
        "sample": "10%",
        "selected": 60,
        "strata": [
            {"family": "robot", "role": "program", "population": 30, "drawn": 3},
            {"family": "robot", "role": "oracle", "population": 20, "drawn": 2},
        ],
    }
}
DOCUMENT = Path(__file__).parents[2] / "docs" / "json.md"
SCHEMA = json.loads(DOCUMENT.with_name("results.schema.json").read_text(encoding="utf-8"))


DIVERGED = (
    Diverged(
        test="tests/test_box.py::test_it",
        at=1.5,
        what="box is not where it is in the original",
        story="box ended 0.3 m from where it ends in the original",
        apart=(Apart("box", "m", 1.5, 0.5, 2.0, 0.3, 0.4, 0.001),),
        fault=1.0,
    ),
)
#: a campaign of what has changed, whose time was not enough
NARROWED = {
    "since": {"ref": "main", "commit": "1a2b3c4d", "run": {"go() in a.py changed": 2}, "taken_over": 3},
    "budget": {"seconds": 60.0, "planned": 3, "run": 1, "cut_off": 1, "is_whole": False},
}


def data(path: Path, **changes: Any) -> Any:
    with Journal.open(samples.write_journal(path / "journal.sqlite", **changes)) as journal:
        return json.loads(dumps(document(read_results(journal))))


def test_a_mutant_has_everything_a_machine_needs(tmp_path: Path) -> None:
    mutant = data(tmp_path)["mutants"][0]
    assert mutant["id"] == samples.REVERSE.id
    assert (mutant["number"], mutant["operator"], mutant["family"]) == (1, "reverse", "robot")
    assert (mutant["role"], mutant["file"], mutant["quantity"]) == ("program", "mission.py", "dx")
    assert mutant["span"] == {"file": "mission.py", "line": 3, "column": 5, "end_line": 3, "end_column": 25}
    assert mutant["description"] == samples.REVERSE.description
    assert mutant["meaning"]["unit"] == "m"
    rate = mutant["kill_rate"]
    assert (rate["killed"], rate["valid"], rate["rate"]) == (2, 2, 1.0)
    assert rate["interval"] == {"low": pytest.approx(0.3424, abs=1e-4), "high": 1.0, "level": 0.95}
    first = mutant["rounds"][0]
    assert (first["round"], first["verdict"], first["by"]) == (1, "killed", "check")
    assert first["test"] == samples.TEST
    assert first["message"].startswith("box is at")


def test_groups_and_rounds_carry_scores_and_counts(tmp_path: Path) -> None:
    found = data(tmp_path)
    program = next(group for group in found["groups"] if group["role"] == "program")
    assert (program["killed"], program["valid"], program["by_check"]) == (3, 5, 1)
    assert program["score"] == pytest.approx(7 / 12)
    assert program["check_score"] == pytest.approx(0.25)
    assert program["counts"]["refused"] == 1
    assert [end["round"] for end in program["rounds"]] == [1, 2]
    assert [(end["round"], end["killed"], end["valid"]) for end in found["rounds"]] == [(1, 1, 3), (2, 3, 5)]


def test_meta_says_with_what_and_how_it_ended(tmp_path: Path) -> None:
    found = data(tmp_path, finish="interrupted")
    assert found["format"] == 2
    assert (found["state"], found["finished"]) == ("interrupted", False)
    assert {"mutabot", "versions", "seed", "rounds", "engine"} <= set(found["meta"])
    assert "vocabulary" not in found["meta"]


def test_a_second_look_is_in_it(tmp_path: Path) -> None:
    found = data(tmp_path, **SECOND_LOOK)
    assert (found["verification"]["checked"], found["verification"]["agreed"]) == (10, 9)
    (wrong,) = found["verification"]["disagreements"]
    assert (wrong["id"], wrong["round"], wrong["first"]) == (samples.SKIP.id, 2, "survived")
    assert found["flaky"] == ["test_a in round 1: failed and passed in equal runs"]
    assert found["repeats"]["doubted"] == {"outcomes": 4, "repeated": 4, "changed": 1}
    kills = found["repeats"]["false_kills"]
    assert (kills["low"], kills["high"], kills["known"], kills["unknown"]) == (0, 3, 3, 0)
    assert found["repeats"]["false_survivors"] is None
    assert not set(SECOND_LOOK) & set(found["meta"])
    without = data(tmp_path)
    assert (without["verification"], without["flaky"]) == (None, [])


def test_a_sample_carries_what_it_says_about_all(tmp_path: Path) -> None:
    found = data(tmp_path, **DRAWING)
    assert found["sample"] == {"size": "10%", "selected": 60}
    program = found["groups"][0]
    assert (program["mutants"], program["population"]) == (3, 30)
    assert 0 <= program["sample_interval"]["low"] < program["score"] < program["sample_interval"]["high"]
    assert program["sample_check_interval"]["level"] == 0.95
    assert "drawing" not in found["meta"]
    whole = data(tmp_path)
    assert (whole["sample"], whole["groups"][0]["population"]) == (None, None)
    assert whole["groups"][0]["sample_interval"] is None


def test_means_carry_their_interval(tmp_path: Path) -> None:
    group = data(tmp_path)["groups"][0]
    assert 0 <= group["interval"]["low"] < group["score"] < group["interval"]["high"] <= 1
    assert group["interval"]["level"] == 0.95
    assert group["check_interval"]["high"] > group["check_score"]


def test_rounds_that_were_not_run_are_there_without_a_verdict(tmp_path: Path) -> None:
    found = data(tmp_path, outcomes=())
    assert found["mutants"][0]["rounds"][1] == {"round": 2, "verdict": None}
    assert found["groups"][0]["score"] is None


def test_numbers_that_json_cannot_hold_become_null(tmp_path: Path) -> None:
    odd = Outcome(samples.SKIP.id, 0, Verdict.SURVIVED, example=(math.nan, math.inf), distance=math.inf)
    path = samples.write_journal(tmp_path / "journal.sqlite", outcomes=(odd,))
    with Journal.open(path) as journal:
        text = dumps(document(read_results(journal)))
    assert json.loads(text, parse_constant=pytest.fail)


def test_the_plan_has_the_same_keys_for_a_mutant(tmp_path: Path) -> None:
    planned = plan_data(samples.MUTANTS, samples.LEFT_OUT, Untested())
    result = data(tmp_path)["mutants"][0]
    assert planned["mutants"][0].items() <= result.items()
    assert planned["left_out"][0]["reason"] == "it is always 0"


def full(path: Path) -> Any:
    """A document with all that one may hold."""
    outcomes = tuple(
        replace(outcome, diverged=DIVERGED, confirmed=False)
        if outcome.verdict is Verdict.SURVIVED
        else outcome
        for outcome in samples.OUTCOMES
    )
    shard = {"number": 2, "of": 8, "mutants": [1]}
    told = {
        "operators": {"reverse": "sends a quantity with the other sign"},
        "draws": ["reverse"],
        "reaching": {"tests": [samples.TEST], "sites": {samples.REVERSE.site.id: [0]}},
    }
    return data(path, outcomes=outcomes, shard=shard, **told, **SECOND_LOOK, **DRAWING, **NARROWED)


def test_a_document_keeps_the_published_schema(tmp_path: Path) -> None:
    found = full(tmp_path)
    jsonschema.validate(found, SCHEMA)
    empty = {key for key, value in found.items() if value in (None, [], {})}
    assert empty <= {"attempt", "graded", "set_aside", "altered", "sections"}
    assert not {"since", "budget"} & found["meta"].keys()


@pytest.mark.parametrize("part", ["rounds", "groups", "mutants", "left_out", "controls", "baseline"])
def test_the_schema_refuses_what_it_does_not_name_and_misses_what_is_gone(tmp_path: Path, part: str) -> None:
    found = data(tmp_path)
    first = found[part][0]
    for changed in ({**first, "another": 1}, dict([*first.items()][1:])):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**found, part: [changed]}, SCHEMA)


def keys(schema: Any) -> Iterator[tuple[str, str]]:
    """The keys of all objects that a schema knows, but for the numbers per verdict, with their texts."""
    parts = schema if isinstance(schema, list) else [*schema.values()] if isinstance(schema, dict) else []
    if isinstance(schema, dict) and {*(own := schema.get("properties", {}))} != {*Verdict}:
        yield from ((name, field.get("description", "")) for name, field in own.items())
    for part in parts:
        yield from keys(part)


def test_the_schema_says_what_each_key_means() -> None:
    found = [*keys(SCHEMA)]
    assert len(found) > 100
    assert [name for name, text in found if not text] == []


def test_the_page_names_every_key_of_the_document_and_no_other() -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    cells = re.findall(r"^\| (`.*?) \|", text.partition("## ")[0], re.MULTILINE)
    assert {name for cell in cells for name in re.findall(r"`(\w+)`", cell)} == {*SCHEMA["properties"]}


def test_a_package_adds_a_section(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = ExtensionPart("sizes", "report.test_json:sizes", "another")
    monkeypatch.setattr("mutabot.report.document.brought", lambda kind: {"sizes": own})
    found = data(tmp_path)
    assert found["sections"] == {"sizes": {"mutants": len(samples.MUTANTS), "rounds": 2}}
    jsonschema.validate(found, SCHEMA)


def test_a_section_that_fails_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = ExtensionPart("sizes", "report.test_json:SCHEMA", "another")
    monkeypatch.setattr("mutabot.report.document.brought", lambda kind: {"sizes": own})
    with pytest.raises(ExtensionError, match=r"'sizes' of package 'another' .* makes no section"):
        data(tmp_path)


def sizes(results: Results) -> dict[str, int]:
    return {"mutants": len(results.mutants), "rounds": results.rounds}
