"""The pages show what commands print in the published experiment."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import pages
from docs.test_tutorial import is_shown

PAPER = pages.ROOT / "examples" / "paper"
MUTABOT = ["-m", "mutabot"]
#: page -> how a block of it begins -> the commands whose output it shows
QUOTES = {
    "README.md": {
        "no.  role": [[*MUTABOT, "results"], [str(pages.ROOT / "benchmarks" / "paper_scores.py"), "."]]
    },
    "docs/reports.md": {"SURVIVED\t31": [[*MUTABOT, "report", "--format", "lines"]]},
    "docs/reading-a-report.md": {
        "no.  role": [[*MUTABOT, "results"]],
        "family · role": [[*MUTABOT, "results"]],
        "Not counted": [[*MUTABOT, "results"]],
        "What the robot did": [[*MUTABOT, "show", "55"]],
    },
    "docs/thresholds.md": {"fault ": [[*MUTABOT, "thresholds"]]},
}


#: the arguments of a further run that a block needs; those without one come before them
FURTHER = {
    "What the robot did": ["--only", "55"],
    "fault ": ["--family", "graded", "--only", "*move_by#2:x:*", "--only", "*move_by#2:z:*"],
}


def printed(project: Path, command: list[str]) -> str:
    """What a command prints at the width of the pages."""
    environment = {**os.environ, "COLUMNS": "100"}
    environment.pop("PYTEST_DISABLE_PLUGIN_AUTOLOAD", None)  # its tests need pytest-bdd
    done = subprocess.run(
        [sys.executable, *command], cwd=project, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the experiment after the campaign of the page."""
    copy = tmp_path_factory.mktemp("published") / "paper"
    shutil.copytree(PAPER, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
    printed(copy, [*MUTABOT, "run", "--only", "@published.txt"])
    return copy


def quote(page: str, start: str) -> str:
    """The block of a page that begins so, without the command that a console shows."""
    texts = [block.text for block in pages.blocks((pages.ROOT / page).read_text(encoding="utf-8"))]
    lines = [[line for line in text.splitlines(keepends=True) if not line.startswith("$ ")] for text in texts]
    (found,) = ["".join(those) for those in lines if those and those[0].startswith(start)]
    return found


@pytest.mark.whole
@pytest.mark.parametrize(
    ("page", "start"), [(page, start) for page, quotes in QUOTES.items() for start in quotes]
)
def test_a_page_shows_what_the_published_experiment_prints(project: Path, page: str, start: str) -> None:
    if start in FURTHER:
        printed(project, [*MUTABOT, "run", *FURTHER[start]])
    text = "".join(printed(project, command) for command in QUOTES[page][start])
    assert is_shown(f"…\n{quote(page, start)}\n…", text), text
