"""The vocabularies that come with mutabot. Whether they fit the packages, ``make shipped`` finds out."""

from __future__ import annotations

from pathlib import Path

import pytest

from check_shipped import compare
from mutabot.errors import VocabularyError
from mutabot.vocabulary import load
from mutabot.vocabulary.load import shipped

DOCS = Path(__file__).parents[2] / "docs" / "vocabulary.md"
URX = "urx.urrobot:URRobot.movel"


@pytest.mark.parametrize("name", shipped())
def test_it_loads_and_is_documented(name: str, tmp_path: Path) -> None:
    assert load([name], tmp_path).operations
    assert f"| `{name}` |" in DOCS.read_text(encoding="utf-8")


@pytest.mark.parametrize("names", [["urx", "own.toml"], ["own.toml", "urx"]])
def test_a_file_of_ones_own_goes_before_a_shipped_one(names: list[str], tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(
        f'[[operation]]\ncall = "{URX}"\n'
        'arguments."tpose[2]" = { kind = "translation", axis = "z", unit = "m", mode = "by" }\n'
    )
    found = {one.target: one for one in load(names, tmp_path).operations}
    assert [one.name for one in found[URX].arguments] == ["tpose[2]"]
    assert len(found) == len(load(["urx"], tmp_path).operations)


def test_the_clock_and_probes_of_ones_own_go_before_shipped_ones(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(
        'clock = { tick = "pybullet:stepSimulation", step = 0.01 }\n'
        '[[probe]]\ncall = "mutabot.cells:world"\ntolerance = 0.5\n'
    )
    found = load(["cell", "own.toml"], tmp_path)
    assert found.clock is not None
    assert found.clock.tick == "pybullet:stepSimulation"
    assert [probe.tolerance for probe in found.probes] == [0.5]


def test_two_files_of_ones_own_still_may_not_disagree(tmp_path: Path) -> None:
    for name, axis in (("a.toml", "x"), ("b.toml", "y")):
        quantity = f'{{ kind = "translation", axis = "{axis}", unit = "m", mode = "by" }}'
        (tmp_path / name).write_text(f'[[operation]]\ncall = "{URX}"\narguments."tpose[0]" = {quantity}\n')
    with pytest.raises(VocabularyError, match="described twice, differently"):
        load(["a.toml", "urx", "b.toml"], tmp_path)


def test_the_cell_that_comes_with_mutabot_has_what_its_vocabulary_says(tmp_path: Path) -> None:
    assert list(compare(load(["cell"], tmp_path))) == []


def test_what_a_package_does_not_have_is_found(tmp_path: Path) -> None:
    (tmp_path / "wrong.toml").write_text(
        '[[operation]]\ncall = "json:JSONEncoder.encode"\n'
        'arguments.height = { kind = "translation", axis = "z", unit = "m", mode = "by" }\n'
        '[[operation]]\ncall = "json:JSONEncoder.lift"\n'
    )
    found = list(compare(load(["wrong.toml"], tmp_path)))
    assert len(found) == 2
    assert any("has no argument 'height'" in problem for problem in found)
    assert any("has no 'lift'" in problem for problem in found)
