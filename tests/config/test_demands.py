"""Demands in the configuration: what they mean, and what is said of those that mean nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration
from mutabot.errors import ConfigurationError
from mutabot.model import Kind
from mutabot.thresholds.demands import Demand

GOOD = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\n'


def demands(folder: Path, text: str) -> tuple[Demand, ...]:
    (folder / "tests").mkdir(exist_ok=True)
    (folder / "mission.py").write_text("")
    (folder / "mutabot.toml").write_text(GOOD + text)
    return load_configuration(folder).demands


def test_a_demand_is_read_with_its_place(tmp_path: Path) -> None:
    text = (
        '[[demand]]\nnotice = "5 mm"\n'
        '[[demand]]\nsite = "mission.py:38"\nquantity = "y"\nkind = "translation"\n'
        'notice = "1 cm"\n'
    )
    assert demands(tmp_path, text) == (
        Demand(5.0, "mm", source="mutabot.toml:3"),
        Demand(1.0, "cm", "mission.py:38", "y", Kind.TRANSLATION, source="mutabot.toml:5"),
    )


def test_without_demands_there_are_none(tmp_path: Path) -> None:
    assert demands(tmp_path, "") == ()


@pytest.mark.parametrize("notice", ["3", '"3"'])
def test_a_plain_number_has_no_unit(tmp_path: Path, notice: str) -> None:
    (found,) = demands(tmp_path, f'[[demand]]\nkind = "count"\nnotice = {notice}\n')
    assert (found.notice, found.unit) == (3.0, None)


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ('site = "a.py:1"', "the key 'notice' is missing"),
        ('notice = "5 mn"', "unknown unit 'mn'; did you mean 'm"),
        ('notice = "5 millimeters"', "did you mean 'mm'"),
        ('notice = "five mm"', "'five mm' is not a magnitude; write a number and a unit, like '5 mm'"),
        ('notice = "-5 mm"', "a magnitude is more than 0; both directions are meant"),
        ('notice = "5 mm"\nquantitty = "y"', "unknown key 'quantitty'; did you mean 'quantity'?"),
        ('notice = "5 mm"\nkind = "translaton"', "unknown kind 'translaton'; did you mean 'translation'?"),
        ('notice = "5 mm"\nkind = "rotation"', "'mm' measures no offset of a rotation; use rad, mrad, deg"),
        ('notice = "5"\nkind = "rotation"', "a rotation has a unit"),
        ('notice = "5 mm"\nkind = "count"', "it has no unit"),
        ('notice = "5 mm"\nsite = "16-20"', "'16-20' is the number of a mutant, which may change"),
        ('notice = "5 mm"\noperator = "ofset"', "unknown graded operator 'ofset'; did you mean 'offset'?"),
        ("notice = true", "notice"),
        ('notice = "5 mm"\nsite = ""', "site"),
    ],
)
def test_mistakes_are_reported_with_their_line_and_what_is_right(
    tmp_path: Path, lines: str, words: str
) -> None:
    with pytest.raises(ConfigurationError) as caught:
        demands(tmp_path, f"[[demand]]\n{lines}\n")
    assert words in str(caught.value)
    assert str(caught.value).startswith("mutabot.toml:")
    assert "demand" in str(caught.value)


def test_single_brackets_are_reported(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"write \[\[demand\]\] with double brackets"):
        demands(tmp_path, '[demand]\nnotice = "5 mm"\n')
