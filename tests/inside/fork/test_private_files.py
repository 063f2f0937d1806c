"""A process with private files sees the project as it was, and nobody sees what it does there."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.inside.fork.private_files import private_folders

CODE = """
import os, pathlib, shutil, sys
from mutabot.inside.fork.private_files import make_private

root = pathlib.Path(sys.argv[1])
os.chdir(root)
reason = make_private(str(root), str(root / ".mutabot/work/home"), str(root / ".mutabot"))
if reason is not None:
    print("not here:", reason)
    raise SystemExit
pathlib.Path("report.txt").write_text("mine")
(root / "data/part.csv").unlink()
(root / "data").rename(root / "moved")
(root / ".mutabot/common.txt").write_text("ours")
(root / ".mutabot/work/home/report.txt").write_text("ours")
shutil.rmtree(root / ".mutabot/work/other home")
pathlib.Path(sys.argv[2]).write_text("temporary")
print(pathlib.Path("report.txt").read_text(), sorted(os.listdir(root)), sorted(os.listdir(root / "moved")))
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    root = tmp_path / "project, with: a strange name"
    (root / ".mutabot/work/home").mkdir(parents=True)
    (root / ".mutabot/work/other home").mkdir()
    (root / "data").mkdir()
    (root / "data/part.csv").write_text("1")
    (root / "data/other.csv").write_text("2")
    (root / "report.txt").write_text("original")
    return root


def test_what_a_process_does_stays_with_it(project: Path, tmp_path: Path) -> None:
    temporary = tmp_path / "temporary.txt"
    done = subprocess.run(
        [sys.executable, "-c", CODE, str(project), str(temporary)], capture_output=True, text=True, check=True
    )
    if done.stdout.startswith("not here"):
        pytest.skip(done.stdout)
    assert done.stdout.strip() == "mine ['.mutabot', 'moved', 'report.txt'] ['other.csv']"
    assert (project / "report.txt").read_text() == "original"
    assert {path.name for path in (project / "data").iterdir()} == {"other.csv", "part.csv"}
    assert not temporary.exists()
    assert (project / ".mutabot/common.txt").read_text() == "ours"
    assert (project / ".mutabot/work/home/report.txt").read_text() == "ours"
    # what belongs to other processes cannot be deleted from here
    assert (project / ".mutabot/work/other home").is_dir()


def test_the_project_and_temporary_files_are_private(tmp_path: Path) -> None:
    folders = private_folders("/home/me/project")
    assert folders[0] == "/home/me/project"
    assert len(folders) == 2
    inner = private_folders(str(tmp_path))
    assert inner.index(str(tmp_path.resolve())) == len(inner) - 1  # the outer folder is covered first
