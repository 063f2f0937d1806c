"""What is shipped: a project's files, named by their content, on a machine while somebody uses them."""

from __future__ import annotations

import io
import os
import sys
import tarfile
from pathlib import Path

import pytest

from mutabot_dask.bundle import Bundle
from mutabot_dask.environment import apply, decided, differences, module_folders
from mutabot_dask.worker_side import Store

from .clusters import shipment_of


def project(folder: Path) -> Path:
    for name, text in {
        "src/mission.py": "x = 1\n",
        "tests/test_mission.py": "",
        "data/table.csv": "1,2\n",
        "mutabot.toml": 'program = ["src/mission.py"]\nfamilies = ["conventional"]\n',
        ".mutabot/journal.sqlite": "",
        "__pycache__/mission.pyc": "",
    }.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    (folder / "out").mkdir()
    script = folder / "run.sh"
    script.write_text("#!/bin/sh\n")
    script.chmod(0o755)
    return folder


def packed(folder: Path) -> Bundle:
    return Bundle.make(shipment_of(folder))


def names(bundle: Bundle) -> set[str]:
    with tarfile.open(fileobj=io.BytesIO(bundle.data)) as tar:
        return set(tar.getnames())


def test_it_holds_what_outcomes_depend_on(tmp_path: Path) -> None:
    bundle = packed(project(tmp_path / "cell"))
    assert bundle.inner == "cell"
    expected = {"mutabot.toml", "src/mission.py", "tests/test_mission.py", "data/table.csv", "out", "run.sh"}
    assert names(bundle) == {f"cell/{name}" for name in expected}


def test_its_name_is_that_of_its_content(tmp_path: Path) -> None:
    first = packed(project(tmp_path / "a" / "cell"))
    other = project(tmp_path / "b" / "cell")
    assert packed(other).digest == first.digest
    (other / "src" / "mission.py").write_text("x = 2\n")
    assert packed(other).digest != first.digest


def test_what_configures_pytest_comes_along_from_above(tmp_path: Path) -> None:
    cell = project(tmp_path / "repository" / "robots" / "cell")
    (tmp_path / "repository" / "pytest.ini").write_text("[pytest]\n")
    (tmp_path / "repository" / "secret.txt").write_text("")
    bundle = packed(cell)
    assert bundle.inner == "repository/robots/cell"
    assert "repository/pytest.ini" in names(bundle)
    assert not any("secret" in name for name in names(bundle))


def test_a_worker_unpacks_it_when_the_last_part_has_come(tmp_path: Path) -> None:
    bundle = packed(project(tmp_path / "cell"))
    store = Store(tmp_path)
    assert not store.has(bundle.digest)
    half = len(bundle.data) // 2
    store.take(bundle.digest, 1, 2, bundle.data[half:])
    assert not store.has(bundle.digest)
    store.take(bundle.digest, 0, 2, bundle.data[:half])
    assert store.has(bundle.digest)
    assert os.access(store.place(bundle.digest) / "cell" / "run.sh", os.X_OK)
    store.take(bundle.digest, 0, 1, bundle.data)  # a second one is as good
    assert store.has(bundle.digest)


def test_a_worker_keeps_the_project_of_one_campaign_and_none_after_it(tmp_path: Path) -> None:
    bundle = packed(project(tmp_path / "cell"))
    store = Store(tmp_path / "worker")
    (tmp_path / "worker").mkdir()
    store.take(bundle.digest, 0, 1, bundle.data)
    assert not store.has("another")
    assert list((tmp_path / "worker").iterdir()) == []
    store.take(bundle.digest, 0, 1, bundle.data)
    store.clear()
    assert list((tmp_path / "worker").iterdir()) == []


def test_of_a_bundle_that_cannot_be_unpacked_nothing_is_left(tmp_path: Path) -> None:
    store = Store(tmp_path)
    with pytest.raises(tarfile.ReadError):
        store.take("digest", 0, 1, b"no archive")
    assert not store.has("digest")
    assert list(tmp_path.iterdir()) == []


def test_the_controller_decides_how_texts_are_hashed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("PYTHONHASHSEED", raising=False)
    monkeypatch.delenv("PYTEST_ADDOPTS", raising=False)
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    found = decided()
    assert found["PYTHONHASHSEED"] is None  # mutabot sets one where there is none
    assert found["OMP_NUM_THREADS"] == "2"
    assert found["PYTEST_ADDOPTS"] is None
    assert "PYTHONPATH" not in found
    for name in ("MUTABOT_WORKERS_PYTHONPATH", "PYTHONPATH", *found):
        monkeypatch.setenv(name, "theirs")
    monkeypatch.delenv("MUTABOT_WORKERS_PYTHONPATH")
    for _ in range(2):
        apply(found, ["/a", "/b"])
    assert "PYTHONHASHSEED" not in os.environ
    assert "PYTEST_ADDOPTS" not in os.environ
    assert os.environ["PYTHONPATH"] == "/a:/b:theirs"


def test_a_project_installed_in_place_is_imported_from_its_copy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell = project(tmp_path / "cell")
    (cell / ".venv" / "bin").mkdir(parents=True)
    monkeypatch.setattr(sys, "path", [*sys.path, str(cell / "src"), str(cell / ".venv" / "bin")])
    monkeypatch.setenv("PYTHONPATH", "lib")
    assert module_folders(cell) == ("lib", "src")


def test_differences_name_both_sides() -> None:
    here = {"python": "CPython 3.12.1", "numpy": "2.0", "mutabot's own code": "#a", "same": "1"}
    there = {"python": "CPython 3.11.2", "mutabot's own code": "#b", "same": "1", "extra": "3"}
    assert differences(here, there) == [
        "python is CPython 3.11.2 there, CPython 3.12.1 here",
        "extra is 3 there, missing here",
        "mutabot's own code is another",
        "numpy is missing there, 2.0 here",
    ]
