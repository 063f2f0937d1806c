"""After a change in a robot program run the mutants whose tests execute a routine that is now another."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from mutabot.model.source_units import File
from mutabot_languages.registry import language_for
from tests import command

FILES = {
    "a.mod": """MODULE A
  VAR num count := 0;
  PROC main()
    count := 3;
  ENDPROC
  PROC late()
    count := 5;
    count := 5;
  ENDPROC
ENDMODULE
""",
    "b.src": "DEF b( )\nTOTAL=TOTAL+1\nEND\n",
    "b.dat": "DEFDAT B\nDECL REAL TOTAL=1\nENDDAT\n",
    "c.script": "def unused(k):\n  x = k\nend\ntextmsg(2)\nx = 1\ny = x + 1\n",
}
TESTS = """
from mutabot_cell import Cell
from mutabot_languages import load

def ends(file, routine=""):
    return load(file).run(Cell(1), routine).variables

def test_a():
    assert ends("a.mod")["count"] == 3

def test_b():
    assert ends("b.src")["total"] == 2

def test_c():
    assert ends("c.script")["y"] == 2

def test_late():
    assert ends("a.mod", "late")["count"] == 5
"""


def git(folder: Path, *words: str) -> None:
    who = ("-c", "user.name=a", "-c", "user.email=a@b.c")
    subprocess.run(["git", *who, *words], cwd=folder, check=True, capture_output=True)


def mutabot(folder: Path, *options: str) -> str:
    """Run a campaign; all that it says."""
    done = command.mutabot(folder, "run", "-o", "repeats=false", *options)
    return " ".join((done.stdout + done.stderr).split())


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project after a whole campaign, all of it in a repository."""
    folder = tmp_path_factory.mktemp("project")
    for name, text in FILES.items():
        (folder / name).write_text(text, newline="\n")
    (folder / "test_all.py").write_text(TESTS)
    (folder / ".gitignore").write_text(".mutabot\n__pycache__\n")
    files = ", ".join(f'"{name}"' for name in FILES)
    (folder / "mutabot.toml").write_text(
        f'program = [{files}]\nvocabulary = []\ntests = ["test_all.py"]\n'
        'families = ["program-conventional"]\n'
    )
    git(folder, "init", "-q")
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "all")
    mutabot(folder)
    return folder


MOD, SRC, DAT, SCRIPT = FILES.values()
LAYOUT = {
    "a.mod": MOD.replace("PROC main()", "! first\n\n  PROC main() ! more").replace("\n", "\r\n"),
    "b.src": SRC.replace("TOTAL=", "; why\n\n  TOTAL=").replace("\n", "\r\n"),
    "b.dat": DAT.replace("\n", "\n; c\n", 1),
    "c.script": f"# a\n\n{SCRIPT}".replace("y =", "  # b\ny ="),
}
LATE = {"a.mod": MOD.replace("count := 5", "count := 4", 1)}
UNUSED = {"c.script": SCRIPT.replace("x = k", "x = k + 1")}
#: what is changed, and why something is to run
CHANGES = {
    "comments, empty lines, indentation and ends of lines": (LAYOUT, ""),
    "a routine that no test calls": (UNUSED, "unused() in c.script changed"),
    "a routine of the last test alone": (LATE, "late() in a.mod changed"),
    "data of a routine": ({"b.dat": DAT.replace("=1", "=1.0")}, "module level of b.dat changed"),
}


@pytest.mark.parametrize(
    "name",
    [
        name if name.startswith(("comments", "data")) else pytest.param(name, marks=pytest.mark.whole)
        for name in CHANGES
    ],
)
def test_only_what_a_change_can_have_altered_runs_again(name: str, project: Path, tmp_path: Path) -> None:
    changed, why = CHANGES[name]
    folder = tmp_path / "copy"
    shutil.copytree(project, folder)
    for file, text in changed.items():
        (folder / file).write_text(text, newline="")
    said = mutabot(folder, "--since", "HEAD")
    pattern = r"since HEAD .*?: (\d+) to run, (\d+) taken over(?: \d+ to run: (.*?) mutants 0/)?"
    found = re.search(pattern, said)
    assert found, said
    assert (int(found[1]) > 0, found[3] or "") == (why != "", why)
    # those that the tests before have killed
    assert int(found[2]) > 0


def test_an_outcome_that_is_taken_over_names_the_line_of_now(project: Path, tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(project, folder)
    (folder / "c.script").write_text(LAYOUT["c.script"])
    said = mutabot(folder, "--since", "HEAD", "--json")
    assert "c.script:9: x has no value" in said
    assert "c.script:6: x has no value" not in said


@pytest.mark.parametrize("name", FILES)
def test_places_of_a_text_are_found_in_one_with_another_layout(name: str) -> None:
    told = language_for(name).units
    old, new = (File(name, text.encode(), told) for text in (FILES[name], LAYOUT[name]))
    assert old.digests == new.digests
    moved = old.moves_to(new)
    assert len(moved) > 3
    for was, now in moved.items():
        if now is not None and len(was) == 4:
            assert part(FILES[name], was) == part(LAYOUT[name], now)


def part(text: str, extent: tuple[int, ...]) -> str:
    """The text at an extent, of one line."""
    first, start, last, end = extent
    return text.splitlines()[first - 1][start:end] if first == last else ""
