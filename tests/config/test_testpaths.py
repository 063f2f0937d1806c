"""Tests that pytest's own configuration names: mutabot runs those that plain pytest runs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration
from mutabot.testpaths import test_paths as paths_of

TOML = '{} = ["checks", "more/*_tests"]\n'
CONFIGURATIONS = {
    "list in pyproject": {"pyproject.toml": "[tool.pytest.ini_options]\n" + TOML.format("testpaths")},
    "text in pyproject": {"pyproject.toml": "[tool.pytest.ini_options]\ntestpaths = 'checks more/*_tests'\n"},
    "pytest.ini": {"pytest.ini": "[pytest]\ntestpaths = checks 'more/*_tests'\n"},
    ".pytest.ini": {".pytest.ini": "[pytest]\ntestpaths =\n  checks\n  more/*_tests\n"},
    "tox.ini": {"tox.ini": "[tox]\n[pytest]\ntestpaths = checks more/*_tests\n"},
    "setup.cfg": {"setup.cfg": "[metadata]\nname = x\n[tool:pytest]\ntestpaths = checks more/*_tests\n"},
    "an empty pytest.ini is taken": {
        "pytest.ini": "", "setup.cfg": "[tool:pytest]\ntestpaths = checks\n",
    },
    "pytest.ini before pyproject": {
        "pytest.ini": "[pytest]\ntestpaths = checks\n",
        "pyproject.toml": "[tool.pytest.ini_options]\ntestpaths = ['more']\n",
    },
    "pyproject without a section": {
        "pyproject.toml": "[tool.other]\nx = 1\n", "tox.ini": "[pytest]\ntestpaths = more\n",
    },
    "nothing is there": {"pytest.ini": "[pytest]\ntestpaths = gone\n"},
    "no name": {"pytest.ini": "[pytest]\naddopts = --strict-markers\n"},
}  # fmt: skip
FILES = ("checks/test_a.py", "more/arm_tests/test_b.py", "more/other/test_c.py", "tests/test_d.py")


@pytest.fixture
def project(tmp_path: Path) -> Path:
    for name in FILES:
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("def test():\n    pass\n", encoding="utf-8")
    return tmp_path


def write(project: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (project / name).write_text(text, encoding="utf-8")


def collected(project: Path, *arguments: str) -> set[str]:
    """The files of the tests that pytest collects in the project."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider", *arguments]
    done = subprocess.run(command, cwd=project, capture_output=True, text=True, check=True)
    return {line.partition("::")[0] for line in done.stdout.splitlines() if "::" in line}


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_the_same_tests_are_named_as_plain_pytest_collects(project: Path, name: str) -> None:
    write(project, CONFIGURATIONS[name])
    found = paths_of(project)
    assert collected(project, *found) == collected(project)
    assert bool(found) is (collected(project) != set(FILES))


def test_they_are_the_tests_of_a_configuration_that_names_none(project: Path) -> None:
    write(project, {**CONFIGURATIONS["pytest.ini"], "mission.py": "", "robot.toml": ""})
    own = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\n'
    write(project, {"mutabot.toml": own})
    assert load_configuration(project).tests == ("checks", "more/arm_tests")
    write(project, {"mutabot.toml": own + 'tests = ["tests"]\n'})
    assert load_configuration(project).tests == ("tests",)


@pytest.mark.parametrize(
    "text", ["[pytest", "[pytest]\ntestpaths", "[pytest]\ntestpaths = 'a b", "\udce9", "[pytest]\n[pytest]\n"]
)
def test_a_file_that_cannot_be_read_names_none(project: Path, text: str) -> None:
    (project / "pytest.ini").write_text(text, encoding="utf-8", errors="surrogateescape")
    assert paths_of(project) == ()
