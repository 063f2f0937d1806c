"""A process with private files sees the project as it was, and nobody sees what it does there."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from mutabot.runtime.isolation.files import private_folders

#: whether this system has what is needed, as other tools find it
_OVERLAY = "cd {folder} && mkdir lower upper work && mount -t overlay -o {options} overlay lower"
_LAYERS = "lowerdir=lower,upperdir=upper,workdir=work"


@pytest.fixture(scope="module", autouse=True)
def overlays(tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp("overlay")
    options, how = (_LAYERS, "-m") if os.geteuid() == 0 else (f"{_LAYERS},userxattr", "-rm")
    command = ["unshare", how, "sh", "-c", _OVERLAY.format(folder=folder, options=options)]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=600)
    if done.returncode:
        pytest.skip(f"no private mounts here: {done.stderr}")


@pytest.fixture
def project() -> Iterator[Path]:
    """A project among the temporary files."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder, "project, with: a strange name")
        (root / ".mutabot/work/home").mkdir(parents=True)
        (root / ".mutabot/work/other home").mkdir()
        (root / ".mutabot/journal.sqlite").write_text("outcomes")
        (root / "data").mkdir()
        (root / "data/part.csv").write_text("1")
        (root / "data/other.csv").write_text("2")
        (root / "report.txt").write_text("original")
        yield root


PRIVILEGED = pytest.mark.skipif(os.geteuid() != 0, reason="an ordinary user's overlay renames no folders")

BEGINNING = """
import os, pathlib, shutil, sys, tempfile
from mutabot.runtime.isolation.files import PrivateFiles

root, home = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[1]) / ".mutabot/work/home"
os.chdir(root)
files = PrivateFiles(str(root), str(home))
assert not (why_not := files.make()), why_not
"""


def said_by(code: str, *arguments: object) -> str:
    """What a process prints that has private files, and does this with them."""
    command = [sys.executable, "-c", BEGINNING + code, *map(str, arguments)]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=600)
    assert done.stderr == ""
    return done.stdout.strip()


ALONE = """
pathlib.Path("report.txt").write_text("mine")
(root / "data/part.csv").unlink()
(root / "data").rename(root / "moved")
os.truncate(root / ".mutabot/journal.sqlite", 0)
(home / "report.txt").write_text("ours")
shutil.rmtree(root / ".mutabot/work/other home")
pathlib.Path(sys.argv[2]).write_text("temporary")
print(pathlib.Path("report.txt").read_text(), sorted(os.listdir(root)), sorted(os.listdir(root / "moved")))
"""


@PRIVILEGED
def test_what_a_process_does_stays_with_it(project: Path, tmp_path: Path) -> None:
    temporary = tmp_path / "temporary.txt"
    assert said_by(ALONE, project, temporary) == "mine ['.mutabot', 'moved', 'report.txt'] ['other.csv']"
    assert (project / "report.txt").read_text() == "original"
    assert {path.name for path in (project / "data").iterdir()} == {"other.csv", "part.csv"}
    assert not temporary.exists()
    assert (project / ".mutabot/journal.sqlite").read_text() == "outcomes"
    assert (project / ".mutabot/work/home/report.txt").read_text() == "ours"
    # what belongs to other processes cannot be deleted from here
    assert (project / ".mutabot/work/other home").is_dir()


def test_the_project_temporary_files_and_shared_memory_are_private(project: Path) -> None:
    temporary = str(Path(tempfile.gettempdir()).resolve())
    assert set(private_folders("/home/me/project")) == {"/home/me/project", temporary, "/dev/shm"}
    inner = private_folders(str(project))
    assert inner.index(temporary) < inner.index(str(project.resolve()))  # the outer folder is covered first


RENAMED = """
file, path = tempfile.mkstemp()
os.rename(path, "report.txt")
print(os.path.getsize("report.txt"))
"""


def test_files_move_between_temporary_ones_and_a_project_among_them(project: Path) -> None:
    assert said_by(RENAMED, project) == "0"
    assert (project / "report.txt").read_text() == "original"


FORKED = """
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
    files.continue_separately(str(own))
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


@PRIVILEGED
def test_a_fork_goes_on_with_a_copy_of_what_its_parent_did(project: Path) -> None:
    seen = "['parent', ['.mutabot', 'moved', 'new', 'report.txt'], ['other.csv']]"
    assert said_by(FORKED, project) == f"{seen} parent again ['other.csv']"
    assert (project / "report.txt").read_text() == "original"


SHARED = """
memory = pathlib.Path("/dev/shm", f"mutabot-{os.getpid()}")
memory.mkdir()
(memory / "pose").write_text("parent")
(home / "forks/1/1").mkdir(parents=True)
pid = os.fork()
if pid == 0:
    files.continue_separately(str(home / "forks/1"))
    seen = (memory / "pose").read_text()
    (memory / "pose").write_text("child")
    inner = os.fork()
    if inner == 0:
        files.continue_separately(str(home / "forks/1/1"))
        (home / "seen").write_text(seen + " " + (memory / "pose").read_text())
        (memory / "pose").unlink()
        os._exit(0)
    assert os.waitpid(inner, 0)[1] == 0
    os._exit((memory / "pose").read_text() != "child")
assert os.waitpid(pid, 0)[1] == 0
print((home / "seen").read_text(), (memory / "pose").read_text(), memory)
"""


def test_forks_of_forks_go_on_with_copies_of_what_is_in_shared_memory(project: Path) -> None:
    *seen, memory = said_by(SHARED, project).split()
    assert seen == ["parent", "child", "parent"]
    assert not Path(memory).exists()
