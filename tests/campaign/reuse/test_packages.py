"""An edit of a package that takes part in a run is seen, whatever its version says, wherever it lies."""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from mutabot import extensions
from mutabot.campaign.reuse.packages import code_of_packages

EXTENSION = """
from mutabot.extensions import INTERFACE, Extension
EXTENSION = Extension(interface=INTERFACE, operators={"creep": "%s:Creep"})
"""


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder from which packages are imported, as pip fills it."""
    folder = tmp_path / "env" / "site-packages"
    folder.mkdir(parents=True)
    monkeypatch.syspath_prepend(folder)
    yield folder
    extensions._declared.cache_clear()
    for name in [name for name in sys.modules if name.startswith("creeps")]:
        del sys.modules[name]


def write(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    importlib.invalidate_caches()
    extensions._declared.cache_clear()


def installed(site: Path, name: str, module: str, files: list[str], editable: Path | None = None) -> None:
    """Note in the folder that this was installed; an extension if it has a ``module``."""
    info = f"{name}-1.0.dist-info"
    told = {"METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n"}
    if module:
        told["entry_points.txt"] = f"[mutabot]\nlab = {module}:EXTENSION\n"
    if editable is not None:
        told["direct_url.json"] = json.dumps({"url": editable.as_uri(), "dir_info": {"editable": True}})
    told["RECORD"] = "".join(
        f"{file_name},,\n" for file_name in [*files, *(f"{info}/{file_name}" for file_name in told)]
    )
    write(site, {f"{info}/{file_name}": text for file_name, text in told.items()})


def is_seen(name: str, file: Path, root: Path) -> bool:
    """Whether an edit of a file changes what is known of a package."""
    before = code_of_packages(root).get(name)
    file.write_text(file.read_text() + "\n")
    return before is not None and code_of_packages(root).get(name) != before


FILES = {"creeps/__init__.py": EXTENSION % "creeps.rules", "creeps/rules.py": "", "creeps/table.txt": "1"}


def test_a_package_counts_with_its_helpers_and_data(site: Path, tmp_path: Path) -> None:
    write(site, FILES)
    installed(site, "lab", "creeps", list(FILES))
    for file in FILES:
        assert is_seen("lab", site / file, tmp_path / "project"), file


def test_of_a_module_the_other_files_of_its_distribution_count_and_those_of_others_do_not(
    site: Path, tmp_path: Path
) -> None:
    files = {"creeps.py": EXTENSION % "creeps", "creeps_help.py": "", "creeps.json": "{}"}
    write(site, {**files, "stranger.py": ""})
    installed(site, "lab", "creeps", list(files))
    for file in files:
        assert is_seen("lab", site / file, tmp_path / "project"), file
    assert not is_seen("lab", site / "stranger.py", tmp_path / "project")


@pytest.mark.parametrize("module", ["creeps", ""])
def test_what_is_worked_on_counts_where_it_lies(
    module: str, site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    work = tmp_path / "work"
    monkeypatch.syspath_prepend(work / "src")
    write(work, {f"src/{name}": text for name, text in FILES.items()} | {"src/beside.py": ""})
    installed(site, "lab", module, ["lab.pth"], editable=work)
    for file in (*FILES, "beside.py"):
        assert is_seen("lab", work / "src" / file, tmp_path / "project"), file


def test_a_module_on_the_path_counts_with_what_is_beside_it(
    tmp_path: Path, site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shared = tmp_path / "shared"
    write(shared, {"creeps.py": EXTENSION % "creeps", "creeps_help.py": "", "creeps.csv": "1"})
    monkeypatch.syspath_prepend(shared)
    installed(site, "lab", "creeps", [])
    for file in ("creeps.py", "creeps_help.py", "creeps.csv"):
        assert is_seen("lab", shared / file, tmp_path / "project"), file


def test_what_lies_in_the_project_is_known_as_its_own(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = tmp_path / "project"
    monkeypatch.syspath_prepend(root)
    write(root, FILES)
    installed(site, "lab", "creeps", [], editable=root)
    assert code_of_packages(root).get("lab", ()) == ()


def test_of_other_packages_the_version_is_enough(site: Path, tmp_path: Path) -> None:
    write(site, {"numbers.py": ""})
    installed(site, "numbers", "", ["numbers.py"])
    assert "numbers" not in code_of_packages(tmp_path)
