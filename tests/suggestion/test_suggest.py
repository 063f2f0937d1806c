"""``mutabot suggest`` on small projects in all three styles: what it suggests really kills."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.cli.app import main

from .projects import PYTEST, SCENARIO, STEPS, UNITTEST, found_by, make, passes, patched

STYLES = {
    "pytest": {"test_rail.py": PYTEST},
    "unittest": {"test_rail.py": UNITTEST},
    "pytest-bdd": {"test_rail.py": STEPS, "rail.feature": SCENARIO},
}


def survivors(found: dict[str, Any]) -> set[str]:
    """The ids of mutants that a campaign let through."""
    return {one["id"] for one in found["mutants"] if one["rounds"][0]["verdict"] == "survived"}


def killed(found: dict[str, Any]) -> set[str]:
    """The ids of mutants that suggestions are said to kill."""
    return {kill["mutant"]["id"] for one in found["suggestions"] for kill in one["kills"]}


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.usefixtures("plugins")
def test_what_is_suggested_kills_when_it_is_applied(
    style: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = make(tmp_path, STYLES[style])
    monkeypatch.chdir(folder)
    before = survivors(found_by(["run"], capsys))
    tree = {path: path.read_bytes() for path in folder.rglob("*.*") if ".mutabot" not in path.parts}

    found = found_by(["suggest", "--seeds", "8"], capsys)

    assert {path: path.read_bytes() for path in tree} == tree, "the user's tree has changed"
    assert {one["style"] for one in found["suggestions"]} == {style}
    never = {one["mutant"]["id"] for one in found["unsolved"]}
    assert killed(found) | never == before
    assert killed(found)
    assert not killed(found) & never
    patched(folder, found["diff"])
    assert passes(folder)
    assert survivors(found_by(["run"], capsys)) == never


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.usefixtures("plugins")
def test_a_written_file_runs_and_kills(
    style: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = make(tmp_path, STYLES[style])
    monkeypatch.chdir(folder)
    found_by(["run"], capsys)

    found = found_by(["suggest", "--seeds", "8", "--write", "tests/test_more.py"], capsys)

    assert (folder / "tests" / "test_more.py").is_file()
    assert passes(folder, "tests/test_more.py")
    assert killed(found).isdisjoint(survivors(found_by(["run"], capsys)))
    assert main(["suggest", "--write", "tests/test_more.py"]) == 2
    assert "exists" in capsys.readouterr().err
