"""The page about families is generated: its sentences follow from the numbers, whatever these are."""

from __future__ import annotations

import copy
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from comparison import page as tool
from comparison.claims import CLAIMS, Stance, decide, difference, difference_text, finding
from comparison.data import comparison_data
from comparison.families import WEAKNESSES, compare_families
from mutabot.report.document import dumps
from mutabot.results.statistics import wilson

from . import campaigns

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
PLACES = CLAIMS[0]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A made-up comparison as `mutabot compare --json --no-oracle` prints it."""
    folder = tmp_path_factory.mktemp("made")
    results = campaigns.read(campaigns.write(folder / "compare.sqlite"))
    without = campaigns.read(campaigns.write(folder / "other.sqlite", luck=2))
    return json.loads(dumps(comparison_data(compare_families(results, without))))


@pytest.fixture
def data(made: Any) -> Any:
    return copy.deepcopy(made)


def family(data: Any, name: str) -> Any:
    return next(group for group in data["families"] if (group["family"], group["role"]) == (name, "program"))


def share(count: int, of: int) -> dict[str, Any]:
    found = wilson(count, of)
    assert found is not None
    interval = {"low": found.low, "high": found.high, "level": found.level}
    return {"count": count, "of": of, "unknown": 0, "share": count / of, "interval": interval}


def written(data: Any, folder: Path) -> Path:
    file = folder / "comparison.json"
    file.write_text(json.dumps(data), encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("conventional", "robot", "stance"),
    [
        (share(60, 100), share(20, 100), Stance.FOR),
        (share(20, 100), share(60, 100), Stance.AGAINST),
        (share(21, 100), share(20, 100), Stance.UNDECIDED),
        (share(6, 10), share(3, 10), Stance.UNDECIDED),
        ({**share(60, 100), "interval": None}, share(20, 100), Stance.UNDECIDED),
    ],
)
def test_a_share_decides_if_the_interval_of_the_difference_does(
    conventional: Any, robot: Any, stance: Stance
) -> None:
    assert decide(conventional, robot) is stance


def test_the_interval_of_a_difference_is_the_published_one() -> None:
    """Newcombe (1998), table II, contrast (a), method 10: 56/70 − 48/80."""
    found = difference(share(56, 70), share(48, 80))
    assert found is not None
    assert found == pytest.approx((0.2, 0.0524, 0.3339), abs=5e-5)


def test_a_difference_is_said_with_its_sign_and_mirrors() -> None:
    assert difference_text(share(56, 70), share(48, 80)) == "+20.0 (5.2 to 33.4)"
    assert difference_text(share(48, 80), share(56, 70)) == "−20.0 (−33.4 to −5.2)"
    assert "(−" in difference_text(share(21, 100), share(20, 100))


@pytest.mark.parametrize(("key", "claim"), list(zip(WEAKNESSES, CLAIMS[1:5], strict=True)))
def test_each_weakness_speaks_for_or_against_its_own_claim(data: Any, key: str, claim: Any) -> None:
    family(data, "text")["weaknesses"][key] = share(90, 100)
    family(data, "robot")["weaknesses"][key] = share(5, 100)
    assert finding(claim, data, "text").stance is Stance.FOR
    family(data, "robot")["weaknesses"][key] = share(100, 100)
    weakness = finding(claim, data, "text")
    assert weakness.stance is Stance.AGAINST
    assert "90/100" in weakness.sentence
    assert "100/100" in weakness.sentence


def test_fewer_informative_mutants_speak_for_the_claim(data: Any) -> None:
    claim = CLAIMS[-1]
    family(data, "conventional")["informative"] = share(5, 100)
    family(data, "robot")["informative"] = share(90, 100)
    assert finding(claim, data, "conventional").stance is Stance.FOR
    family(data, "robot")["informative"] = share(1, 100)
    family(data, "conventional")["informative"] = share(50, 100)
    assert finding(claim, data, "conventional").stance is Stance.AGAINST


@pytest.mark.parametrize(
    ("places", "stance"), [(3, Stance.FOR), (30, Stance.AGAINST), (10, Stance.UNDECIDED)]
)
def test_the_larger_number_of_places_decides(data: Any, places: int, stance: Stance) -> None:
    family(data, "conventional")["places"] = places
    assert family(data, "robot")["places"] == 10
    assert finding(PLACES, data, "conventional").stance is stance


def test_a_family_without_a_mutant_has_too_few_places_and_says_nothing_else(data: Any) -> None:
    family(data, "text").update(mutants=0, places=0, planned=0, done=0)
    stances = [finding(claim, data, "text").stance for claim in CLAIMS]
    assert stances == [Stance.FOR, *[Stance.UNKNOWN] * (len(CLAIMS) - 1)]


def test_a_family_that_was_not_run_says_nothing(data: Any) -> None:
    data["families"] = [group for group in data["families"] if group["family"] != "text"]
    assert {finding(claim, data, "text").stance for claim in CLAIMS} == {Stance.UNKNOWN}


def test_a_sample_does_not_show_how_many_places_there_are(data: Any) -> None:
    data["sample"] = {"size": "10%", "selected": 900}
    assert finding(PLACES, data, "conventional").stance is Stance.UNKNOWN


def test_the_page_holds_every_claim_family_and_example(data: Any) -> None:
    text = tool.page({"paper": data, "scales": data})
    for claim in CLAIMS:
        assert text.count(f"| {claim.name} | ") == 2
        assert claim.statement in text
    for name in ("paper", "scales"):
        assert f"| {name}: robot · program |" in text
        assert f"(img/comparison-{name}.svg)" in text


def test_the_table_says_of_each_claim_and_family_what_was_found(data: Any) -> None:
    rows = re.findall(
        r"^\| ([\w ]+) \| (conventional|text) \| (.+) \|$", tool.page({"paper": data}), re.MULTILINE
    )
    assert [(claim, family) for claim, family, _ in rows] == [
        (claim.name, family) for claim in CLAIMS for family in ("conventional", "text")
    ]
    for claim, (_, family, told) in zip([wanted for wanted in CLAIMS for _ in range(2)], rows, strict=True):
        stated = finding(claim, data, family)
        assert told.strip("*").startswith(stated.stance.value)
        assert stated.sentence in told or stated.stance is Stance.UNKNOWN


def test_other_numbers_make_another_page(data: Any) -> None:
    before = tool.page({"paper": data})
    family(data, "text")["weaknesses"]["broken"] = share(0, 180)
    assert "**for**: 0/180" not in tool.page({"paper": data})
    assert tool.page({"paper": data}) != before


def test_comparisons_are_stored_without_single_mutants_and_the_page_is_checked(
    data: Any, tmp_path: Path
) -> None:
    docs = tmp_path / "docs"
    assert tool.main([f"paper={written(data, tmp_path)}"], docs) == 0
    stored = json.loads((docs / "data" / "paper.json").read_text(encoding="utf-8"))
    assert "mutants" not in stored
    assert stored["families"] == data["families"]
    assert (docs / "img" / "comparison-paper.svg").is_file()
    assert tool.main(["--check"], docs) == 0
    (docs / "comparison.md").write_text("edited", encoding="utf-8")
    assert tool.main(["--check"], docs) == 1
    assert tool.main([], docs) == 0
    assert tool.main(["--check"], docs) == 0


def test_without_a_comparison_there_is_no_page(tmp_path: Path) -> None:
    assert tool.main([], tmp_path) == 0
    assert tool.main(["--check"], tmp_path) == 0
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("argument", ["paper", "=x", "paper=", "../x=y.json", "paper=nowhere.json"])
def test_an_argument_that_is_no_named_comparison_is_refused(
    argument: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert tool.main([argument], tmp_path) == 2
    assert capsys.readouterr().err


def test_a_campaign_that_was_not_completed_is_refused(
    data: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data.update(finished=False, state="interrupted")
    assert tool.main([f"paper={written(data, tmp_path)}"], tmp_path / "docs") == 2
    assert "interrupted" in capsys.readouterr().err
    assert not (tmp_path / "docs").exists()


def test_docs_comparison_md_is_up_to_date() -> None:
    done = subprocess.run([sys.executable, "-m", "comparison.page", "--check"], cwd=BENCHMARKS, check=False)
    assert done.returncode == 0, "run `make docs`"
