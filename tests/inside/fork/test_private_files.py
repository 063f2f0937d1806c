"""A process with private files sees the project as it was, and nobody sees what it does there."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from mutabot.inside.fork.private_files import private_folders

CODE = """
import os, pathlib, shutil, sys
from mutabot.inside.fork.private_files import PrivateFiles

root = pathlib.Path(sys.argv[1])
os.chdir(root)
reason = PrivateFiles(str(root), str(root / ".mutabot/work/home"), str(root / ".mutabot")).make()
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


def test_the_project_temporary_files_and_shared_memory_are_private(tmp_path: Path) -> None:
    temporary = str(Path(tempfile.gettempdir()).resolve())
    assert set(private_folders("/home/me/project")) == {"/home/me/project", temporary, "/dev/shm"}
    inner = private_folders(str(tmp_path))
    assert inner.index(temporary) < inner.index(str(tmp_path.resolve()))  # the outer folder is covered first


SHARED = """
import os, pathlib, sys
from mutabot.inside.fork.private_files import PrivateFiles

root, home = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[1]) / ".mutabot/work/home"
memory = pathlib.Path("/dev/shm", f"mutabot-{os.getpid()}")
files = PrivateFiles(str(root), str(home), str(root / ".mutabot"))
reason = files.make()
if reason is not None:
    print("not here:", reason)
    raise SystemExit
memory.mkdir()
(memory / "pose").write_text("parent")
(home / "forks/1/1").mkdir(parents=True)
pid = os.fork()
if pid == 0:
    files = files.go_on_apart(str(home / "forks/1"))
    seen = (memory / "pose").read_text()
    (memory / "pose").write_text("child")
    inner = os.fork()
    if inner == 0:
        files.go_on_apart(str(home / "forks/1/1"))
        (home / "seen").write_text(seen + " " + (memory / "pose").read_text())
        (memory / "pose").unlink()
        os._exit(0)
    assert os.waitpid(inner, 0)[1] == 0
    os._exit((memory / "pose").read_text() != "child")
assert os.waitpid(pid, 0)[1] == 0
print((home / "seen").read_text(), (memory / "pose").read_text(), memory)
"""


def test_forks_of_forks_go_on_with_copies_of_what_is_in_shared_memory(project: Path) -> None:
    command = [sys.executable, "-c", SHARED, str(project)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    if done.stdout.startswith("not here"):
        pytest.skip(done.stdout)
    *seen, memory = done.stdout.split()
    assert seen == ["parent", "child", "parent"]
    assert not Path(memory).exists()


RENAMED = """
import os, pathlib, sys, tempfile
from mutabot.inside.fork.private_files import PrivateFiles

root = pathlib.Path(sys.argv[1])
reason = PrivateFiles(str(root), str(root / ".mutabot/work/home"), str(root / ".mutabot")).make()
if reason is not None:
    print("not here:", reason)
    raise SystemExit
file, path = tempfile.mkstemp(dir=tempfile.gettempdir())
os.rename(path, root / "report.txt")
print("renamed")
"""


def test_files_move_between_temporary_ones_and_a_project_among_them(project: Path) -> None:
    if not str(project.resolve()).startswith(str(Path(tempfile.gettempdir()).resolve())):
        pytest.skip("the project of this test lies elsewhere")
    command = [sys.executable, "-c", RENAMED, str(project)]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=60)
    if done.stdout.startswith("not here"):
        pytest.skip(done.stdout)
    assert (done.stdout.strip(), done.stderr) == ("renamed", "")
    assert (project / "report.txt").read_text() == "original"


FORKED = """
import os, pathlib, shutil, sys
from mutabot.inside.fork.private_files import PrivateFiles

root, home = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[1]) / ".mutabot/work/home"
files = PrivateFiles(str(root), str(home), str(root / ".mutabot"))
os.chdir(root)
reason = files.make()
if reason is not None:
    print("not here:", reason)
    raise SystemExit
pathlib.Path("report.txt").write_text("parent")
(root / "data/part.csv").unlink()
(root / "data").rename(root / "moved")
(root / "new").mkdir()
(root / "new/link").symlink_to("../report.txt")
own = home / "forks/1"
own.mkdir(parents=True)
reading, writing = os.pipe()
pid = os.fork()
if pid == 0:
    files.go_on_apart(str(own))
    os.write(writing, b"x")
    seen = [pathlib.Path("new/link").read_text(), sorted(os.listdir(root)), os.listdir(root / "moved")]
    pathlib.Path("report.txt").write_text("child")
    shutil.rmtree(root / "moved")
    (home / "seen").write_text(repr(seen))
    os._exit(0)
os.close(writing)
os.read(reading, 1)
pathlib.Path("report.txt").write_text("parent again")
assert os.waitpid(pid, 0)[1] == 0
print((home / "seen").read_text(), pathlib.Path("report.txt").read_text(), sorted(os.listdir(root / "moved")))
"""


def test_a_fork_goes_on_with_a_copy_of_what_its_parent_did(project: Path) -> None:
    command = [sys.executable, "-c", FORKED, str(project)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    if done.stdout.startswith("not here"):
        pytest.skip(done.stdout)
    seen = "['parent', ['.mutabot', 'moved', 'new', 'report.txt'], ['other.csv']]"
    assert done.stdout.strip() == f"{seen} parent again ['other.csv']"
    assert (project / "report.txt").read_text() == "original"
