"""``mutabot operators``: the catalogue of all faults, in any folder."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mutabot import operators
from mutabot.campaign.faults.providers import operators_of_packages
from mutabot.cli.app import main


@pytest.fixture(autouse=True)
def no_project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_all_operators_are_there_family_by_family(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["operators", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["operators"]
    assert sorted(rule["name"] for rule in found) == sorted([*operators.names(), *operators_of_packages()])
    families = [rule["family"] for rule in found]
    assert len([*dict.fromkeys(families)]) == sum(
        first != second for first, second in zip([None, *families], families, strict=False)
    )


@pytest.mark.needs("catalogue")
def test_one_family_says_what_each_stands_for_and_where(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["operators", "--family", "catalogue"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert text.startswith("catalogue cm-for-m")
    assert "where: written quantities of kind duration" in text
    assert "source: A number in another unit" in text


def test_published_operators_name_the_rows_that_they_make(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["operators", "--family", "robot", "--json"]) == 0
    found = {operator["name"]: operator for operator in json.loads(capsys.readouterr().out)["operators"]}
    assert found["repeat"]["source"] == "Published operators: 8. do command x → do command x twice."
    assert found["repeat"]["where"]


def test_an_unknown_family_is_reported_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["operators", "--family", "catalog"]) == 2
    assert "did you mean 'catalogue'?" in capsys.readouterr().err


def test_nothing_is_left_in_the_folder(tmp_path: Path) -> None:
    assert main(["operators"]) == 0
    assert list(tmp_path.iterdir()) == []
