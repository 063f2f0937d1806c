"""Folders of processes are removed, whatever was made in them, and nothing outside of them is touched."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from mutabot.execution.cleanup import remove_folder


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    home = tmp_path / "home"
    home.mkdir()
    yield home
    if home.exists() and shutil.which("chattr"):
        subprocess.run(["chattr", "-R", "-i", "-a", home], check=False, capture_output=True)
    subprocess.run(["rm", "-rf", home], check=False)


def lock(flag: str, path: Path) -> None:
    if shutil.which("chattr") is None:
        pytest.skip("there is no chattr")
    if subprocess.run(["chattr", flag, path], check=False, capture_output=True).returncode:
        pytest.skip("nobody can make a file immutable here")


def test_folders_that_their_owner_may_not_enter(folder: Path) -> None:
    (folder / "closed/inner").mkdir(parents=True)
    (folder / "closed/inner/file").touch()
    (folder / "closed/inner").chmod(0)
    (folder / "closed").chmod(0)
    remove_folder(folder)
    assert not folder.exists()


def test_thousands_of_folders_in_each_other(folder: Path) -> None:
    here = os.open(".", os.O_RDONLY)
    try:
        os.chdir(folder)
        for _ in range(3000):
            Path("deeper").mkdir()
            os.chdir("deeper")
    finally:
        os.chdir(here)
        os.close(here)
    remove_folder(folder)
    assert not folder.exists()


def test_nothing_is_changed_through_a_link(folder: Path, tmp_path: Path) -> None:
    users = tmp_path / "users"
    users.mkdir(mode=0o750)
    (users / "file").write_text("precious")
    (users / "file").chmod(0o440)
    (folder / "closed").mkdir()
    (folder / "closed/link").symlink_to(users)
    (folder / "closed/link to file").symlink_to(users / "file")
    (folder / "closed").chmod(0)
    remove_folder(folder)
    assert (users / "file").read_text() == "precious"
    assert (users.stat().st_mode & 0o777, (users / "file").stat().st_mode & 0o777) == (0o750, 0o440)


def test_a_folder_that_is_gone_is_no_problem(tmp_path: Path) -> None:
    remove_folder(tmp_path / "gone")


def test_what_nobody_can_remove_stays(folder: Path) -> None:
    (folder / "file").touch()
    lock("+i", folder / "file")
    remove_folder(folder)
    assert folder.exists()
