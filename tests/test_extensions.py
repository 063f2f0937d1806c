"""What packages beside the core bring: found by their entry points, loaded when used, checked."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from mutabot import extensions
from mutabot.languages.registry import languages_of
from mutabot.runtime.exceptions import failure_in

#: prints what is brought
ASK = """
import sys
from mutabot import extensions
from mutabot.errors import ExtensionError
try:
    for part in extensions.brought("vocabularies").values():
        print(part.owner, part.name, part.reference)
    print("loaded:", *sorted(name for name in sys.modules if name.startswith(("lab", "mutabot_", "numpy"))))
except ExtensionError as error:
    print("error:", error)
"""


def installed(folder: Path, code: str, distribution: str = "lab-robots", name: str = "lab") -> Path:
    """A folder as an installer leaves it, with a package that declares what it brings by this code."""
    details = folder / f"{distribution.replace('-', '_')}-1.0.dist-info"
    details.mkdir(parents=True)
    (details / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n")
    (details / "entry_points.txt").write_text(f"[mutabot]\n{name} = {name}_extension:EXTENSION\n")
    (folder / f"{name}_extension.py").write_text(f"from mutabot.extensions import Extension\n{code}\n")
    return folder


def asked(*folders: Path) -> list[str]:
    """What is printed where these folders are among those in which packages are found."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, folders))}
    done = subprocess.run(
        [sys.executable, "-c", ASK], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.needs("cell")
def test_what_a_package_brings_comes_after_what_mutabots_own_bring_and_is_not_loaded(tmp_path: Path) -> None:
    installed(tmp_path, 'EXTENSION = Extension(interface=2, vocabularies={"arm": "lab:arm.toml"})')
    own, other, loaded = asked(tmp_path)
    assert own.startswith("mutabot cell ")
    assert other == "lab-robots arm lab:arm.toml"
    modules = loaded.split()[1:]
    assert "lab_extension" in modules
    assert not {"lab", "numpy"} & {*modules}


@pytest.mark.parametrize(
    ("code", "told"),
    [
        (
            "EXTENSION = Extension(interface=3)",
            "was written for version 3 of the extension interface; this mutabot has version 2",
        ),
        ("EXTENSION = 7", "is int, not a mutabot.extensions.Extension"),
        ("raise RuntimeError('no licence')", "cannot be loaded: RuntimeError('no licence')"),
        ("EXTENSION = Extension()", "cannot be loaded: TypeError"),
        ("", "cannot be loaded: AttributeError"),
    ],
)
def test_a_declaration_that_cannot_be_used_is_an_error_that_names_the_package(
    code: str, told: str, tmp_path: Path
) -> None:
    (line,) = asked(installed(tmp_path, code))
    assert line.startswith("error: package 'lab' of 'lab-robots' (lab_extension:EXTENSION) ")
    assert told in line


@pytest.mark.needs("cell")
def test_two_parts_of_one_name_are_an_error_that_names_both_packages(tmp_path: Path) -> None:
    code = 'EXTENSION = Extension(interface=2, vocabularies={"cell": "lab:cell.toml"})'
    line = asked(installed(tmp_path, code))[-1]
    assert line == "error: 'cell' of package 'lab-robots' has the name of one of 'mutabot' (vocabularies)"


def test_a_file_that_a_package_does_not_have_is_reported_where_it_is_used(tmp_path: Path) -> None:
    code = 'EXTENSION = Extension(interface=2, vocabularies={"arm": "mutabot_cell:arm.toml"})'
    installed(tmp_path, code)
    ask = ASK.replace("part.reference", "part.file")
    done = subprocess.run(
        [sys.executable, "-c", ask],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "error: 'arm' of package 'lab-robots': there is no file mutabot_cell:arm.toml" in done.stdout


def test_exceptions_that_a_package_names_are_those_of_the_tools_in_processes_of_the_tests(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class UnsupportedError(RuntimeError):
        """Raised by a simulator."""

    module = ModuleType("lab_simulator")
    module.UnsupportedError = UnsupportedError  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "lab_simulator", module)
    monkeypatch.setattr(extensions._SentParts, "parts", None)
    assert "failures" in extensions.references_for_processes()
    extensions.use({"failures": {"unsupported": "lab_simulator:UnsupportedError"}})
    assert failure_in(UnsupportedError("no contacts"), ()) == "UnsupportedError: no contacts"
    assert failure_in(RuntimeError("no contacts"), ()) is None


@pytest.mark.needs("languages")
def test_processes_of_the_tests_learn_the_programs_own_languages_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(extensions._SentParts, "parts", None)
    (tmp_path / "cell").mkdir()
    for name in ("cell/pick.mod", "cell/mission.py", "other.src"):
        (tmp_path / name).write_text("")
    assert languages_of(tmp_path, ("cell/mission.py",)) == frozenset()
    assert languages_of(tmp_path, ("cell",)) == {"rapid"}
    assert languages_of(tmp_path, ("cell", "other.src")) == {"rapid", "krl"}
    assert extensions.references_for_processes()["languages"] == {}
    assert [*extensions.references_for_processes({"rapid"})["languages"]] == ["rapid"]
