"""Campaigns with patches end as plain pytest does where git has applied them, by both engines."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.plugins.test_faults import write
from tests.plugins.test_plugins import USAGE, mutabot

PROJECT = {
    "pyproject.toml": """
        [tool.mutabot]
        program = ["cell"]
        families = ["patch"]
        """,
    "conftest.py": "",
    "cell/__init__.py": "",
    "cell/limits.json": '{"speed": 2.0, "force": 10.0}\n',
    "cell/limits.py": """
        import json
        from pathlib import Path

        LIMITS = json.loads(Path(__file__).with_name("limits.json").read_text())

        def clipped(speed):
            return min(speed, LIMITS["speed"])

        def unused(speed):
            return -speed
        """,
    "cell/move.py": """
        from functools import lru_cache

        from cell.limits import clipped

        class Arm:
            def __init__(self, speed=1.0):
                self.speed = speed

            @property
            def fast(self):
                return self.speed > 1.5

            @property
            def slow(self):
                return not self.fast

        @lru_cache
        def go(speed):
            return clipped(speed)

        SPEEDS = [0.5, 5.0]
        TRIED = [1.0, 3.0]

        def speeds():
            for speed in SPEEDS:
                yield go(speed)
        """,
    "tests/helper.py": "LIMIT = 2.0\n",
    "tests/test_move.py": """
        import subprocess
        import sys

        import pytest
        from cell.move import TRIED, Arm, go, speeds

        def test_slow():
            assert go(0.5) == 0.5

        @pytest.mark.parametrize("speed", TRIED)
        def test_all(speed):
            assert go(speed) <= 2.0

        def test_generator():
            assert list(speeds()) == [0.5, 2.0]

        def test_arm():
            assert Arm().slow and Arm(2.0).fast

        def test_in_a_process_below():
            words = [sys.executable, "-c", "from cell.move import go; print(go(1.0))"]
            assert float(subprocess.run(words, check=True, capture_output=True, text=True).stdout) == 1.0
        """,
}
#: the files that each patch changes, and how; in the first ones processes that run can become the mutant
FUNCTIONS = {
    "late": [("cell/move.py", "clipped(speed)", "clipped(speed + 0.25)")],
    "quiet": [("cell/limits.py", "return min(speed,", "return min(speed * 1.0,")],
    "two": [("cell/move.py", "> 1.5", "> 0.5"), ("cell/limits.py", "min(", "max(")],
    "second property": [("cell/move.py", "return not self.fast", "return False")],
    "longer": [("cell/move.py", "return clipped(speed)", "x = 2\n    y = x\n    return y * clipped(speed)")],
    "below": [("cell/limits.py", "return min(speed,", "return 9.0 if speed == 1.0 else min(speed,")],
    "nowhere": [("cell/limits.py", "return -speed", "return speed")],
}
FILES = {
    "data": [("cell/limits.json", "2.0", "4.0")],
    "unread": [("cell/limits.json", "10.0", "99.0")],
    "both": [("cell/limits.json", "2.0", "3.0"), ("cell/move.py", "clipped(speed)", "clipped(speed) + 0")],
    "constant": [("cell/move.py", "[0.5, 5.0]", "[0.5, 5.0, -1.0]")],
    "collected and fails": [
        ("cell/limits.json", "2.0", "2.5"),
        ("cell/move.py", "[1.0, 3.0]", "[1.0, 3.0, 2.5]"),
    ],
    "collected": [("cell/move.py", "[1.0, 3.0]", "[]")],
    "default": [("cell/move.py", "speed=1.0", "speed=1.7")],
    "generator": [("cell/move.py", "yield go(speed)", "yield go(speed) + 1")],
    "import": [("cell/move.py", "SPEEDS = ", "from nowhere import *\nSPEEDS = ")],
}
LEFT_OUT = {
    "suite": [("tests/test_move.py", "0.5", "0.7")],
    "helper": [("tests/helper.py", "2.0", "3.0")],
}
ADDED = "--- /dev/null\n+++ b/cell/more.py\n@@ -0,0 +1,2 @@\n+X = 1\n+Y = 2\n"


def git(folder: Path, *words: str) -> bytes:
    """What git says in a folder."""
    environment = {**os.environ, "GIT_CEILING_DIRECTORIES": str(folder.parent)}
    done = subprocess.run(["git", *words], cwd=folder, env=environment, capture_output=True, check=True)
    return done.stdout


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project with patches, whose files are in a repository."""
    folder = write(tmp_path_factory.mktemp("patches") / "project", PROJECT)
    (folder / ".gitignore").write_text(".mutabot/\n__pycache__/\n")
    git(folder, "init", "-q")
    git(folder, "add", ".")
    git(folder, "-c", "user.name=x", "-c", "user.email=x", "commit", "-qm", "x")
    (folder / "patches").mkdir()
    for name, edits in {**FUNCTIONS, **FILES, **LEFT_OUT}.items():
        for file, before, after in edits:
            text = (folder / file).read_text()
            assert before in text
            (folder / file).write_text(text.replace(before, after, 1))
        (folder / f"patches/{name}.patch").write_bytes(git(folder, "diff"))
        git(folder, "checkout", "-q", ".")
    (folder / "patches/added.patch").write_text(ADDED)
    (folder / "patches/stale.diff").write_text(
        "--- a/cell/move.py\n+++ b/cell/move.py\n@@ -1 +1 @@\n-x\n+y\n"
    )
    return folder


def by_name(told: str) -> dict[str, dict[str, Any]]:
    """Mutants of a JSON document by the names of their patches."""
    found = {
        mutant["description"].partition("/")[2].partition(".patch")[0]: mutant
        for mutant in json.loads(told)["mutants"]
    }
    assert found
    return found


@pytest.mark.whole
def test_patches_end_as_plain_pytest_says_where_git_has_applied_them(project: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(project, tmp_path / "campaign")
    before = {file: file.read_bytes() for file in copy.rglob("cell/*.*")}
    done = mutabot(None, copy, "run", "--json", "-o", "repeats=false")
    found = by_name(done.stdout)
    assert found.keys() == {*FUNCTIONS, *FILES, "added"}
    fails = {name: _plain_fails(project, name, tmp_path) for name in found}
    states = {name: mutant["rounds"][0]["verdict"] for name, mutant in found.items()}
    assert {name: state == "killed" for name, state in states.items()} == fails
    assert states["nowhere"] == "not covered"
    assert {name for name, state in states.items() if state == "survived"} == {
        "quiet", "unread", "collected", "added",
    }  # fmt: skip
    assert {file: file.read_bytes() for file in before} == before
    assert not (copy / "cell/more.py").exists()
    assert f"{len(FILES) + 1} mutants that are active before any point" in done.stderr
    left = {omission["description"]: omission["reason"] for omission in json.loads(done.stdout)["left_out"]}
    assert left == {
        "patches/stale.diff": "hunk 1 does not apply to cell/move.py: line 1 was 'x', and there is "
        "'from functools import lru_cache'",
        **{
            f"patches/{name}.patch": f"{edits[0][0]} belongs to the tests, and a patch to these is no mutant "
            "of the program"
            for name, edits in LEFT_OUT.items()
        },
    }


def _plain_fails(project: Path, name: str, folder: Path) -> bool:
    copy = shutil.copytree(project, folder / name / "project")
    git(copy, "apply", f"patches/{name}.patch")
    words = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    return subprocess.run(words, cwd=copy, capture_output=True, check=False).returncode != 0


@pytest.mark.whole
def test_patches_that_change_functions_alone_are_forked_and_replay_says_the_same(
    project: Path, tmp_path: Path
) -> None:
    ends = []
    for engine in ("fork", "replay"):
        copy = shutil.copytree(project, tmp_path / engine)
        words = [word for name in FUNCTIONS for word in ("--only", f"*{name}.patch*")]
        done = mutabot(None, copy, "run", "--json", "--engine", engine, "-o", "repeats=false", *words)
        found = by_name(done.stdout)
        ends.append(
            {name: [found[name]["rounds"][0][key] for key in ("verdict", "test")] for name in FUNCTIONS}
        )
    assert ends[0] == ends[1]
    assert {verdict for verdict, _ in ends[0].values()} == {"killed", "survived", "not covered"}


def test_functions_that_the_program_has_frozen_are_patched_in_a_fork(project: Path, tmp_path: Path) -> None:
    # the collector does not tell of objects that are frozen
    (project / "conftest.py").write_text("import gc\n\nimport cell.move\n\ngc.freeze()\n")
    names = [name for name in FUNCTIONS if _plain_fails(project, name, tmp_path)]
    assert names
    words = [word for name in names for word in ("--only", f"*{name}.patch*")]
    done = mutabot(None, project, "run", "--json", "--engine", "fork", "-o", "repeats=false", *words)
    assert {mutant["rounds"][0]["verdict"] for mutant in by_name(done.stdout).values()} == {"killed"}


def test_without_a_patch_the_setting_is_named(tmp_path: Path) -> None:
    folder = write(tmp_path, PROJECT)
    done = mutabot(None, folder, "list")
    assert done.returncode == USAGE
    assert "[tool.mutabot.patches] files: 'patches' fits no patch of the project" in done.stderr


def test_a_patch_acts_in_a_process_that_cannot_join(project: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(project, tmp_path / "project")
    suite = copy / "tests/test_move.py"
    suite.write_text(suite.read_text().replace('[sys.executable, "-c"', '[sys.executable, "-E", "-c"'))
    words = [word for name in ("below", "quiet") for word in ("--only", f"*/{name}.patch*")]
    words += ["-o", "repeats=false", "-o", 'pytest_args=["-k", "slow or process_below"]']
    found = by_name(mutabot(None, copy, "run", "--json", *words).stdout)
    states = {name: mutant["rounds"][0]["verdict"] for name, mutant in found.items()}
    assert states == {"below": "killed", "quiet": "survived"}
