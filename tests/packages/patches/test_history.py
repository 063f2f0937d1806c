"""Reverted fixes of a repository's history become patches."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.plugins.test_plugins import USAGE, mutabot

from .test_campaigns import git

FILES = {
    "cell/move.py": "def go(speed):\n    return speed\n",
    "cell/a.json": "1\n",
    "tests/test_move.py": "x = 1\n",
}
#: what each commit makes of which files
COMMITS = {
    "Add a limit": {"cell/move.py": "def go(speed):\n    return min(speed, 3)\n"},
    "Fix the limit": {
        "cell/move.py": "def go(speed):\n    return min(speed, 2)\n",
        "tests/test_move.py": "x = 2\n",
        "a.md": "!\n",
    },
    "Fixture for tests": {"tests/test_move.py": "x = 3\n"},
    "Correct a test, bug 7": {"tests/test_move.py": "x = 4\n"},
    "bugs in data": {"cell/a.json": "2\n"},
    "More data": {"cell/a.json": "3\n"},
}


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project in a folder of its repository, with some history."""
    top = tmp_path_factory.mktemp("history")
    git(top, "init", "-q")
    for message, files in {"x": FILES, **COMMITS}.items():
        for name, text in files.items():
            (top / "robot" / name).parent.mkdir(parents=True, exist_ok=True)
            (top / "robot" / name).write_text(text)
        git(top, "add", ".")
        git(top, "-c", "user.name=x", "-c", "user.email=x", "commit", "-qm", message)
    return top / "robot"


def told(project: Path, *words: str) -> dict[str, tuple[bool, str | None]]:
    """Which commits have a patch, and why others have none."""
    done = mutabot(None, project, "patches", "--from-git", "HEAD~6..HEAD", "--json", *words)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["commits"]
    return {commit["subject"]: (bool(commit["file"]), commit["why_not"]) for commit in found}


def test_fixes_are_taken_back_where_that_still_applies(project: Path) -> None:
    assert told(project) == {
        "Fix the limit": (True, None),
        "Correct a test, bug 7": (False, "it changes no file of the program"),
        "bugs in data": (False, "hunk 1 does not apply to cell/a.json: line 1 was '2', and there is '3'"),
    }
    (patch,) = (project / "patches").glob("*.patch")
    text = patch.read_text()
    assert text.startswith("Reverted: Fix the limit\nCommit: ")
    assert "-    return min(speed, 2)\n+    return min(speed, 3)\n" in text
    assert "tests/" not in text
    assert "a.md" not in text
    git(project.parent, "apply", "--directory=robot", str(patch))
    assert (project / "cell/move.py").read_text() == COMMITS["Add a limit"]["cell/move.py"]
    git(project.parent, "checkout", "-q", ".")


def test_messages_and_files_can_be_chosen(project: Path) -> None:
    assert told(project, "--match", "", "cell/a.json", "--to", "other")["More data"] == (True, None)
    assert told(project, "--match", "limit$", "--to", "other").keys() == {"Add a limit", "Fix the limit"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--from-git", "v0..v1"], "git says: fatal: "),
        (["--from-git", "--output=x"], "'--output=x' is no range of commits, such as v1.0..HEAD"),
        (["--from-git", "HEAD", "--match", "("], "--match '(' is no regular expression"),
        (["--from-git", "HEAD~6..HEAD", "--to", "../x"], "--to ../x lies outside the project"),
    ],
)
def test_what_cannot_be_meant_is_named(words: list[str], said: str, project: Path) -> None:
    done = mutabot(None, project, "patches", *words)
    assert (done.returncode, said in done.stderr) == (USAGE, True), done.stderr
    assert "Traceback" not in done.stderr
