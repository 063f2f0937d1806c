"""Results of a campaign on robot programs in Latin-1: each place is that of the text, in every report."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from tests import command

#: a statement by file, and its line
PLACES = {"a.mod": ("WaitTime 0.5", 4), "b.src": ("WAIT SEC 0.5", 4), "c.script": ("sleep(0.5)", 4)}
FILES = {
    "a.mod": "MODULE A\r\nPROC main()\r\n  ! Größe\r\n  WaitTime 0.5; ! für\r\nENDPROC\r\nENDMODULE\r\n",
    "b.src": "&ACCESS RVP\nDEF b( )\n; Größe\nWAIT SEC 0.5\nEND\n",
    "b.dat": "DEFDAT B\nDECL INT COUNT=1\nENDDAT\n",
    "c.script": "def c():\n  # Größe\n  x = 1\n  sleep(0.5)\nend\n",
}
TESTS = """
import pytest
from mutabot_languages import load

@pytest.mark.parametrize("file", ["a.mod", "b.src", "c.script"])
def test_it_ends(new_cell, mutabot_seed, file):
    cell = new_cell(mutabot_seed)
    load(file).run(cell)
    assert cell.time < 30
"""


def mutabot(folder: Path, *words: str) -> str:
    done = command.mutabot(folder, *words)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project after a campaign in which each mutant of a wait survived: files in Latin-1."""
    folder = tmp_path_factory.mktemp("project")
    for name, text in FILES.items():
        (folder / name).write_bytes(text.encode("latin-1"))
    (folder / "test_all.py").write_text(TESTS)
    (folder / "conftest.py").write_text("from mutabot_cell.fixtures import *\n")
    (folder / "mutabot.toml").write_text(
        'program = ["a.mod", "b.src", "b.dat", "c.script"]\nvocabulary = ["cell"]\ntests = ["test_all.py"]\n'
        'families = ["program-text"]\n'
    )
    mutabot(folder, "run", "--only", "scale-wait", "-o", "repeats=false")
    return folder


def report(project: Path, tmp_path: Path, format: str) -> str:
    file = tmp_path / "report"
    mutabot(project, "report", "--format", format, "-o", str(file))
    return file.read_text(encoding="utf-8-sig")


def test_show_marks_the_statement_in_its_file(project: Path) -> None:
    for mutant in json.loads(mutabot(project, "results", "--json"))["mutants"]:
        text, line = PLACES[mutant["site"].partition(":")[0]]
        shown = mutabot(project, "show", mutant["id"])
        (marked,) = (candidate for candidate in shown.splitlines() if candidate.startswith(">"))
        assert marked.split("│")[0].split() == [">", str(line)]
        assert text in marked
        assert "Gr" not in marked
        assert "Größe" in shown


def test_sarif_has_the_statement_at_its_place(project: Path, tmp_path: Path) -> None:
    found: list[Any] = json.loads(report(project, tmp_path, "sarif"))["runs"][0]["results"]
    places = [item["locations"][0]["physicalLocation"] for item in found]
    assert {item["artifactLocation"]["uri"] for item in places} == PLACES.keys()
    for place in places:
        file, region = place["artifactLocation"]["uri"], place["region"]
        line = FILES[file].splitlines()[region["startLine"] - 1]
        assert line[region["startColumn"] - 1 : region["endColumn"] - 1] == PLACES[file][0]


@pytest.mark.parametrize("format", ["csv", "lines", "markdown", "jsonl"])
def test_each_format_names_file_and_line(format: str, project: Path, tmp_path: Path) -> None:
    text = report(project, tmp_path, format)
    if format == "csv":
        rows = [*csv.DictReader(text.splitlines())]
        assert {(row["file"], int(row["line"])) for row in rows} == {
            (file, line) for file, (_, line) in PLACES.items()
        }
    elif format == "jsonl":
        assert all(f'"{file}' in text for file in PLACES)
    else:
        assert all(f"{file}:{line}" in text for file, (_, line) in PLACES.items())


def test_accepted_mutants_of_robot_programs_are_survivors_no_more(project: Path) -> None:
    mutants = json.loads(mutabot(project, "results", "--json"))["mutants"]
    ids = [mutant["id"] for mutant in mutants if mutant["site"].startswith("a.mod")]
    mutabot(project, "accept", *ids, "--why", "only the time differs")
    text = FILES["b.src"].replace("WAIT SEC 0.5", "WAIT SEC 0.5 ; mutabot: accept *: as well")
    (project / "b.src").write_bytes(text.encode("latin-1"))
    shown = mutabot(project, "run", "--only", "scale-wait", "-o", "repeats=false")
    assert "c.script" in shown
    mutants = json.loads(mutabot(project, "results", "--json"))["mutants"]
    accepted = {mutant["site"].partition(":")[0]: mutant.get("accepted") for mutant in mutants}
    assert accepted["a.mod"]
    assert accepted["b.src"]
    assert not accepted["c.script"]
