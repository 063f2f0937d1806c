"""Recipes that need no robot library run: the draft of init, the campaign, the check that the page adds."""

from __future__ import annotations

import json
import re
import shutil
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

import pages
from mutabot.cli.app import main

RECIPES = pages.ROOT / "docs" / "recipes"
_COUNTS = re.compile(r"(\d+) mutants: (\d+) killed, (\d+) survived(?:, (\d+) refused)?")


def blocks(text: str, language: str) -> list[str]:
    return [block.text for block in pages.blocks(text) if block.language == language]


def campaign(capsys: pytest.CaptureFixture[str], *options: str) -> list[dict[str, Any]]:
    capsys.readouterr()
    assert main(["run", "--json", *options]) == 0
    mutants: list[dict[str, Any]] = json.loads(capsys.readouterr().out)["mutants"]
    return mutants


def verdicts(mutants: list[dict[str, Any]]) -> Counter[str]:
    return Counter(mutant["rounds"][0]["verdict"] for mutant in mutants)


@pytest.mark.whole
@pytest.mark.parametrize(
    ("name", "test_file", "gap"),
    [("plc", "tests/test_press.py", "press.py:11"), ("toolbox", "tests/test_draw.py", "draw.py:15")],
)
def test_a_reader_of_a_recipe_gets_what_its_page_shows(
    name: str,
    test_file: str,
    gap: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    if name == "toolbox":
        pytest.importorskip("numpy")
    page = (RECIPES / f"{name}.md").read_text(encoding="utf-8")
    project = tmp_path / name
    shutil.copytree(RECIPES / name, project, ignore=shutil.ignore_patterns("robot.toml", "__pycache__", ".*"))
    monkeypatch.chdir(project)

    assert main(["init"]) == 0
    drafted, *answers = blocks(page, "toml")
    assert drafted.strip() in (project / "robot.toml").read_text(encoding="utf-8")

    finished = (RECIPES / name / "robot.toml").read_text(encoding="utf-8")
    assert [answer for answer in answers if answer.strip() not in finished] == []
    (project / "robot.toml").write_text(finished, encoding="utf-8")
    found = verdicts(campaign(capsys))
    counts = _COUNTS.search(page)
    assert counts is not None
    assert [found.total(), found["killed"], found["survived"], found["refused"]] == [
        int(count or 0) for count in counts.groups()
    ]

    (check,) = blocks(page, "python")
    with (project / test_file).open("a", encoding="utf-8") as file:
        file.write(f"    {check}")
    mended = {mutant["operator"]: mutant for mutant in campaign(capsys, "--only", gap)}
    assert {operator: mutant["rounds"][0]["verdict"] for operator, mutant in mended.items()} == {
        "skip": "killed",
        "opposite": "killed",
        "repeat": "survived",
    }
