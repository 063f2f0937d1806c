"""Thresholds as text, JSON and TOML: one row per ladder, and nothing that is not known."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import pytest

from mutabot.report.document import data_of, dumps
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.thresholds import bar, print_thresholds
from mutabot.thresholds.thresholds import Thresholds, thresholds_of
from results import samples
from results.thresholds import journals
from results.thresholds.journals import Rungs

FIVE = 5
READING = {"site": samples.READ, "quantity": ".x", "operation": "tracker:box_position"}
LADDERS = (
    Rungs(["SSSSCCC"] * 3 + ["SSSCCXX"] * 2),
    Rungs(["SSSSSRR"] * FIVE, direction="-"),
    Rungs(["SSCSCCC"] * FIVE, site=samples.BACK, unit="deg"),
    Rungs(["RRRRRRR"] * FIVE, site=samples.BACK, unit="deg", direction="-"),
    Rungs(["CCCCCCC"] * FIVE, **READING),  # type: ignore[arg-type]  # each of its own type
    Rungs(["CCCCCCC"] * FIVE, direction="-", **READING),  # type: ignore[arg-type]
)


@pytest.fixture
def thresholds(tmp_path: Path) -> Thresholds:
    return thresholds_of(journals.results(tmp_path, *LADDERS))


def text_of(thresholds: Thresholds, *, width: int = 120) -> str:
    out = io.StringIO()
    print_thresholds(make_console(out, width=width), thresholds)
    return out.getvalue()


def test_a_ladder_is_one_row_with_a_bar(thresholds: Thresholds) -> None:
    text = text_of(thresholds)
    assert re.search(r"mission.py:3 arm.move_by dx \+ +5 mm +···▒███ +20 mm +check in 5 of 5", text)
    assert "× the robot refuses" in text


def test_a_round_that_does_not_count_is_named_with_the_reason(tmp_path: Path) -> None:
    rounds = ["SSSSCCC", "UUUUUUU", *["SSSSCCC"] * 3]
    found = thresholds_of(journals.results(tmp_path, Rungs(rounds)))
    text = text_of(found)
    assert "Rounds that do not count" in text
    assert "round 2 is unstable" in text


def test_a_bar_has_one_sign_per_magnitude(thresholds: Thresholds) -> None:
    assert [bar(ladder) for ladder in thresholds.ladders] == [
        "·····××",
        "····███",
        "···▒███",
        "███████",
        "███████",
    ]


def test_the_loosest_comes_first(thresholds: Thresholds) -> None:
    assert [(ladder.name, ladder.unit) for ladder in thresholds.ladders] == [
        ("arm.move_by dx −", "mm"),
        ("arm.move_by dx +", "deg"),
        ("arm.move_by dx +", "mm"),
        ("tracker.box_position .x +", "mm"),
        ("tracker.box_position .x −", "mm"),
    ]


def test_a_sentence_sums_up_all_ladders(thresholds: Thresholds) -> None:
    sentence = (
        "1 of 6 graded faults not noticed at any size that the robot accepts; "
        "4 noticed in every round from some size on; 1 not judged"
    )
    assert thresholds.summary == sentence
    assert sentence in text_of(thresholds, width=300)


@pytest.mark.parametrize(
    ("rounds", "kind"),
    [
        (["SSSSSSS", "SSSSSSS"], "not noticed even at the largest size tried"),
        (["SSCSSSS", "SSSSSSS"], "not noticed even at the largest size tried"),
        (["SSSSSSS", "SSSSRRR"], "not noticed at any size that the robot accepts"),
        (["SSSSSSS", "SSSSSSC"], "noticed in some rounds only"),
        (["SSSSSSC", "CCCCCCC"], "noticed in every round from some size on"),
        (["SSSSNNN", "SSSSSSS"], "not noticed at any size that has an effect"),
        (["-------", "-------"], "reached by no test"),
        (["NNNNNNN", "NNNNNNN"], "not judged"),
        (["UUUUUUU", "UUUUUUU"], "not judged"),
    ],
)
def test_each_ladder_is_of_one_kind(tmp_path: Path, rounds: list[str], kind: str) -> None:
    found = thresholds_of(journals.results(tmp_path, Rungs(rounds)))
    assert found.summary == f"1 of 1 graded fault {kind}"


def test_what_the_lines_say_of_further_rounds_has_its_level(thresholds: Thresholds) -> None:
    text = text_of(thresholds, width=300)
    assert "With 94 % confidence the median threshold" in text
    assert "at least 55 % of further rounds do" in text


def test_all_that_is_to_be_said_is_said(thresholds: Thresholds) -> None:
    text = " ".join(text_of(thresholds, width=300).split())
    assert "noticed at 5 mm" not in text
    assert "noticed at 5 deg, survives 10 deg, rounds 1 to 5" in text
    assert "the robot refuses every magnitude that was tried" in text


def test_json_holds_every_ladder_and_round(thresholds: Thresholds) -> None:
    data = json.loads(dumps(data_of(thresholds)))
    by_name = {(ladder["name"], ladder["unit"]): ladder for ladder in data["ladders"]}
    first = by_name["arm.move_by dx +", "mm"]
    assert (first["none_up_to"], first["half_from"], first["all_from"]) == (5.0, 20.0, 20.0)
    assert first["median"] == {"above": 5.0, "at_most": 20.0, "level": 0.9375}
    assert [end["noticed"] for end in first["rounds"]] == [20.0, 20.0, 20.0, 10.0, 10.0]
    refused = by_name["arm.move_by dx −", "mm"]
    assert (refused["all_from"], refused["refused_from"]) == (None, 50.0)
    assert by_name["arm.move_by dx −", "deg"]["judged"] is False


def test_the_document_names_every_key(thresholds: Thresholds) -> None:
    document = (Path(__file__).parents[3] / "docs" / "thresholds.md").read_text(encoding="utf-8")
    missing = [key for key in keys_of(json.loads(dumps(data_of(thresholds)))) if f"`{key}`" not in document]
    assert missing == []


def keys_of(data: object) -> set[str]:
    if isinstance(data, dict):
        return {*data, *(key for value in data.values() for key in keys_of(value))}
    return {key for value in data for key in keys_of(value)} if isinstance(data, list) else set()
