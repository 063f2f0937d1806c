"""A comparison of families as JSON and as a picture."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from comparison.bars import COLOURS, FamilyBar, bars_of, picture_of
from comparison.data import comparison_data
from comparison.drawing import Rectangle, svg
from comparison.ends import End
from comparison.families import FamilyComparison, compare_families
from mutabot.report.document import dumps

from . import campaigns

DOCUMENT = Path(__file__).parents[2] / "docs" / "compare.md"


@pytest.fixture(scope="module")
def comparison(tmp_path_factory: pytest.TempPathFactory) -> FamilyComparison:
    folder = tmp_path_factory.mktemp("made")
    results = campaigns.read(campaigns.write(folder / "compare.sqlite"))
    return compare_families(results, campaigns.read(campaigns.write(folder / "other.sqlite", luck=2)))


def test_json_holds_the_numbers_and_where_they_come_from(comparison: FamilyComparison) -> None:
    data = json.loads(dumps(comparison_data(comparison)))
    robot = data["families"][0]
    assert (robot["family"], robot["role"], robot["mutants"]) == ("robot", "program", 30)
    assert sum(share["count"] for share in robot["ends"].values()) == robot["done"] == 90
    assert robot["informative"]["of"] == 30
    assert robot["scores"]["score"] == comparison.families[0].scores.mean
    assert robot["without_oracle"]["valid"] > 0
    assert data["together"]["killed_mutants"] == comparison.redundancy.killed
    assert len(data["mutants"]) == 222
    assert all(len(mutant["ends"]) == 3 for mutant in data["mutants"])
    assert {mutant["dominator"] for mutant in data["mutants"]} - {None} == set(
        range(1, data["together"]["dominators"] + 1)
    )


def test_json_names_no_folder_of_the_machine(comparison: FamilyComparison) -> None:
    assert "root" in comparison.meta
    assert "root" not in comparison_data(comparison)["meta"]


def test_every_end_is_documented_in_its_order() -> None:
    text = DOCUMENT.read_text(encoding="utf-8").partition("## What became of them")[2]
    rows = re.findall(r"^\| ([^|`]+) \|", text, re.MULTILINE)
    assert [row for row in rows if row in set(End)][: len(End)] == [end.value for end in End]


def test_bars_are_as_long_as_each_other_and_their_parts_as_the_shares(comparison: FamilyComparison) -> None:
    picture = picture_of(bars_of(comparison.families), "title")
    bars: dict[float, list[Rectangle]] = {}
    for box in picture.boxes[1:]:
        if box.height == 34:
            bars.setdefault(box.y, []).append(box)
    assert len(bars) == len(comparison.families)
    lengths = {round(sum(box.width for box in bar), 6) for bar in bars.values()}
    assert len(lengths) == 1
    for bar, family in zip(bars.values(), comparison.families, strict=True):
        shares = [share.share for share in family.ends.values() if share.count]
        assert [box.width / lengths.copy().pop() for box in bar] == pytest.approx(shares)


def test_every_end_has_a_colour_of_its_own() -> None:
    assert set(COLOURS) == set(End)
    assert len(set(COLOURS.values())) == len(End)


def test_a_family_of_which_nothing_was_run_is_a_bar_without_parts() -> None:
    picture = picture_of([FamilyBar("text", "program", dict.fromkeys(End, 0))], "title")
    assert len(picture.boxes) == 1
    assert any(words.text == "nothing was run" for words in picture.words)


def test_svg_is_well_formed_whatever_names_hold() -> None:
    text = svg(picture_of([FamilyBar("<&>\"'", "r & d", {End.CHECK: 1})], "a < b"), by="a test")
    root = ET.fromstring(text)
    words = [node.text for node in root.iter("{http://www.w3.org/2000/svg}text")]
    assert "a < b" in words
    assert "<&>\"'" in words


def test_nothing_lies_outside_the_picture(comparison: FamilyComparison) -> None:
    picture = picture_of(bars_of(comparison.families), "title")
    for box in picture.boxes:
        assert 0 <= box.x <= box.x + box.width <= picture.width
        assert 0 <= box.y <= box.y + box.height <= picture.height
    assert all(0 < words.y < picture.height for words in picture.words)
