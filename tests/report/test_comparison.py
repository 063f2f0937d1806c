"""Families side by side: as a table, as JSON and as a picture."""

from __future__ import annotations

import io
import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from rich.cells import cell_len

from analysis import campaigns
from mutabot.analysis.ends import End
from mutabot.analysis.families import FamilyComparison, Share, compare_families
from mutabot.analysis.statistics import Interval
from mutabot.campaign.run import run_campaign
from mutabot.errors import UsageError
from mutabot.report.as_json import dumps
from mutabot.report.comparison_json import comparison_data
from mutabot.report.picture import _COLOURS, FamilyBar, Rectangle, bars_of, picture_of, svg
from mutabot.report.picture_file import check_picture, write_picture
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.side_by_side import duration, print_comparison, share_cell
from tests.campaign.project import Quiet, request_for, write_project

DOCUMENT = Path(__file__).parents[2] / "docs" / "compare.md"
WIDTHS = pytest.mark.parametrize("width", [60, 80, 120, 200])


@pytest.fixture(scope="module")
def comparison(tmp_path_factory: pytest.TempPathFactory) -> FamilyComparison:
    folder = tmp_path_factory.mktemp("made")
    results = campaigns.read(campaigns.write(folder / "compare.sqlite"))
    return compare_families(results, campaigns.read(campaigns.write(folder / "other.sqlite", luck=2)))


def table(comparison: FamilyComparison, width: int = 80) -> str:
    file = io.StringIO()
    print_comparison(make_console(file, width=width), comparison)
    return file.getvalue()


@WIDTHS
def test_no_line_is_wider_than_the_terminal(comparison: FamilyComparison, width: int) -> None:
    text = table(comparison, width)
    assert max(cell_len(line) for line in text.splitlines()) <= width
    assert "\x1b" not in text


@WIDTHS
def test_every_family_has_its_column_and_every_end_its_row(comparison: FamilyComparison, width: int) -> None:
    words = set(table(comparison, width).split())
    for family in comparison.families:
        assert {family.name, family.role} <= words
    for end in End:
        assert set(end.value.split()) <= words


def test_a_row_holds_the_numbers_of_all_families(comparison: FamilyComparison) -> None:
    text = table(comparison, 120)
    row = next(line for line in text.splitlines() if "killed by check" in line)
    for family in comparison.families:
        assert str(family.ends[End.CHECK].count) in row.split()
    assert "without an oracle" in text


def test_a_share_is_a_count_a_percentage_and_its_interval() -> None:
    assert str(share_cell(Share(42, 120, interval=Interval(0.281, 0.444)))).split() == [
        "42", "35", "%", "28–44", "%",
    ]  # fmt: skip
    assert str(share_cell(Share(0, 120, interval=Interval(0.0, 0.03)))) == "0"
    assert str(share_cell(Share(0, 0))) == "–"


def test_what_is_not_known_is_said_and_never_nothing() -> None:
    assert str(share_cell(Share(3, 10, unknown=2))) == "≥ 3"
    assert str(share_cell(Share(0, 10, unknown=2))) == "–"
    assert str(share_cell(Share(0, 10, unknown=10))) == "–"


def test_without_every_test_the_table_says_what_it_does_not_know(tmp_path: Path) -> None:
    found = compare_families(campaigns.read(campaigns.write(tmp_path / "c.sqlite", complete=False)))
    text = table(found)
    assert "not known for mutants that were not run against every test" in " ".join(text.split())
    assert "joint dominators" not in text


def test_a_sample_is_named_with_what_it_was_drawn_from(tmp_path: Path) -> None:
    strata = [{"family": "text", "role": "program", "population": 600, "drawn": 60}]
    drawing = {"sample": "10%", "one_per_site": False, "selected": 2220, "strata": strata}
    text = table(compare_families(campaigns.read(campaigns.write(tmp_path / "c.sqlite", drawing=drawing))))
    assert "a sample of 10% of 2220 mutants" in text
    assert re.search(r"drawn from .* 600", text)


@pytest.mark.parametrize(
    ("seconds", "text"), [(None, "–"), (0.04, "0.0 s"), (99.9, "99.9 s"), (120, "2.0 min"), (7200, "2.0 h")]
)
def test_times_are_said_as_people_say_them(seconds: float | None, text: str) -> None:
    assert duration(seconds) == text


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
    assert all(len(one["ends"]) == 3 for one in data["mutants"])
    assert {one["dominator"] for one in data["mutants"]} - {None} == set(
        range(1, data["together"]["dominators"] + 1)
    )


def test_json_names_no_folder_of_the_machine(comparison: FamilyComparison) -> None:
    assert "root" in comparison.meta
    assert "root" not in comparison_data(comparison)["meta"]


def test_every_key_is_documented_and_no_other(comparison: FamilyComparison) -> None:
    documented = set(re.findall(r"^\| `(\w+)` \|", DOCUMENT.read_text(encoding="utf-8"), re.MULTILINE))
    data = comparison_data(comparison)
    family = data["families"][0]
    parts = [data, family, family["informative"], data["together"], data["mutants"][0]]
    assert {key for part in parts for key in part} == documented


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
    assert set(_COLOURS) == set(End)
    assert len(set(_COLOURS.values())) == len(End)


def test_a_family_of_which_nothing_was_run_is_a_bar_without_parts() -> None:
    picture = picture_of([FamilyBar("text", "program", dict.fromkeys(End, 0))], "title")
    assert len(picture.boxes) == 1
    assert any(words.text == "nothing was run" for words in picture.words)


def test_svg_is_well_formed_whatever_names_hold() -> None:
    text = svg(picture_of([FamilyBar("<&>\"'", "r & d", {End.CHECK: 1})], "a < b"))
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


@pytest.mark.parametrize("name", ["ends", "ends.jpg", "nowhere/ends.svg", ".", "ends.svg.txt"])
def test_a_picture_that_cannot_be_drawn_is_a_usage_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UsageError):
        check_picture(Path(name))


def test_a_picture_of_another_format_is_told_the_name_it_may_have(tmp_path: Path) -> None:
    check_picture(tmp_path / "ends.svg")
    with pytest.raises(UsageError, match=r"ends\.png is no picture .* write .*ends\.svg$"):
        check_picture(tmp_path / "ends.png")


def test_what_mutabot_writes_into_a_project_does_not_make_it_run_again(
    comparison: FamilyComparison, tmp_path: Path
) -> None:
    mission = "def run(arm):\n    arm.move_by(0.5)\n"
    test = "from mission import run\nfrom robot import Arm\n\ndef test_it():\n    run(Arm())\n"
    selections = {"used.txt": "mission.py:run:arm.move_by#1:dx:reverse\n", "other.txt": "mission.py:*\n"}
    folder = write_project(tmp_path, mission, test, more={"used.txt": selections["used.txt"]})
    request = request_for(folder, engine="replay", selection=folder / "used.txt")
    run_campaign(request, Quiet())
    write_picture(comparison, folder / "ends.svg")
    (folder / "comparison.json").write_text(dumps(comparison_data(comparison)))
    (folder / "other.txt").write_text(selections["other.txt"])
    again = Quiet()
    run_campaign(request, again)
    assert any(line.startswith("reused all") for line in again.lines)
    (folder / "arm.urdf").write_text('<mesh file="ends.svg"/>')
    after = Quiet()
    run_campaign(request, after)
    assert any("arm.urdf is new, ends.svg is new" in line for line in after.lines)
