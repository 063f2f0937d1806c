"""What is released, and with what it is made: tracked files, locks with hashes, no name without an owner."""

from __future__ import annotations

import re
import subprocess
import sys
import tarfile
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import pages

LOCKS = sorted(pages.ROOT.glob("requirements*.lock"))
_NAME = re.compile(r"\b(?:pip|uv|pipx) (?:tool )?install [^\n]*")


def git(folder: Path, *words: str) -> None:
    own = ("-c", "user.name=a", "-c", "user.email=a@b")
    subprocess.run(["git", *own, *words], cwd=folder, check=True, capture_output=True)


def built(folder: Path, to: Path) -> subprocess.CompletedProcess[str]:
    """Build a source distribution as `make dist` does."""
    return subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-d", str(to)],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """A repository with this project's files that are part of a release."""
    folder = tmp_path / "clone"
    for name in (
        "pyproject.toml",
        "hatch_build.py",
        "README.md",
        "LICENSE",
        ".gitignore",
        "src/mutabot/__init__.py",
    ):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes((pages.ROOT / name).read_bytes())
    git(folder.parent, "init", "-q", "clone")
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "first")
    return folder


def test_a_source_distribution_holds_what_git_tracks(clone: Path, tmp_path: Path) -> None:
    done = built(clone, tmp_path / "dist")
    assert done.returncode == 0, done.stderr
    (file,) = (tmp_path / "dist").glob("*.tar.gz")
    with tarfile.open(file) as tar:
        names = {name.partition("/")[2] for name in tar.getnames()}
    assert names == {
        "pyproject.toml", "hatch_build.py", "README.md", "LICENSE", ".gitignore", "src/mutabot/__init__.py",
        "PKG-INFO",
    }  # fmt: skip


@pytest.mark.parametrize("secret", [".env", "src/mutabot/key.pem", "id_rsa"])
@pytest.mark.parametrize("is_excluded", [False, True])
def test_a_secret_in_the_folder_is_no_part_of_it(
    secret: str, is_excluded: bool, clone: Path, tmp_path: Path
) -> None:
    (clone / secret).write_text("hunter2")
    if is_excluded:  # for this clone alone: git says nothing of the file, and the builder does not know
        (clone / ".git" / "info" / "exclude").write_text(f"{Path(secret).name}\n")
    done = built(clone, tmp_path / "dist")
    assert done.returncode != 0
    assert f"{secret} is not tracked" in done.stderr
    assert not list((tmp_path / "dist").glob("*"))


def test_a_source_distribution_builds_where_there_is_no_git(clone: Path, tmp_path: Path) -> None:
    built(clone, tmp_path / "dist")
    (file,) = (tmp_path / "dist").glob("*.tar.gz")
    with tarfile.open(file) as tar:
        tar.extractall(tmp_path / "unpacked", filter="data")
    (folder,) = (tmp_path / "unpacked").iterdir()
    assert built(folder, tmp_path / "again").returncode == 0


@pytest.mark.parametrize("lock", LOCKS, ids=lambda lock: str(lock.name))
def test_each_pinned_package_has_the_hashes_of_its_files(lock: Path) -> None:
    text = lock.read_text(encoding="utf-8")
    entries = re.split(r"\n(?=[A-Za-z0-9])", text)
    entries = [entry for entry in entries if "==" in entry.partition("\n")[0] and not entry.startswith("#")]
    assert len(entries) == len(re.findall(r"^[A-Za-z0-9][^\s#]*==", text, re.MULTILINE)) > 0
    bare = [entry for entry in entries if not re.search(r"--hash=sha256:[0-9a-f]{64}", entry)]
    assert bare == []


def test_what_installs_a_lock_file_demands_its_hashes() -> None:
    texts = [(pages.ROOT / name).read_text(encoding="utf-8") for name in ("Makefile", "tools/setup.sh")]
    commands = [
        line for text in texts for line in text.replace("\\\n", " ").splitlines()
        if "pip" in line and " install " in line and re.search(r"-r\s+requirements", line)
    ]  # fmt: skip
    assert len(commands) == len(LOCKS)
    assert not [
        line for line in commands if "--require-hashes" not in line or "--only-binary :all:" not in line
    ]


def test_nobody_is_advised_to_install_a_name_that_nobody_owns() -> None:
    """Until there is a release, mutabot is installed from a folder or a repository."""
    files = [*pages.ROOT.glob("ci/*"), *(pages.ROOT / "src").rglob("*.py"), pages.ROOT / "CONTRIBUTING.md"]
    files += [pages.ROOT / page for page in pages.pages()]
    told = [found[0] for file in files for found in _NAME.finditer(file.read_text(encoding="utf-8"))]
    assert len(told) > 5
    assert [
        line for line in told if re.search(r"""install ['"]?mutabot\b|[\s'"]mutabot(\[|['"\s]|$)""", line)
    ] == []


def test_what_pinned_packages_need_is_pinned_as_well() -> None:
    """Else pip, which demands hashes of everything, installs nothing."""
    text = (pages.ROOT / "requirements.lock").read_text(encoding="utf-8")
    names = {canonicalize_name(name) for name in re.findall(r"^([\w.-]+)==", text, re.MULTILINE)}
    needed = {
        (name, canonicalize_name(requirement.name))
        for name in names
        for requirement in map(Requirement, metadata.requires(name) or ())
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""})
    }
    assert [pair for pair in sorted(needed) if pair[1] not in names] == []
