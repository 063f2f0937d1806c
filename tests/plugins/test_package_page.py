"""The package on docs/packages.md, built and installed as the page says: short, and at work."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.plugins import test_languages
from tests.plugins.test_faults import write
from tests.plugins.test_faults_in_time import PROJECT as BELT
from tests.plugins.test_plugins import mutabot, mutants, python
from tests.plugins.test_plugins import project as project  # noqa: PLC0414  # a fixture

import pages

PAGE = Path(__file__).parents[2] / "docs" / "packages.md"
#: a project whose program is in the language of the page
steps = test_languages.project


def files() -> dict[str, str]:
    """The files of the package by path: each block of the page whose first line names one."""
    blocks = (block.text.partition("\n") for block in pages.blocks(PAGE.read_text(encoding="utf-8")))
    return {first.removeprefix("# "): text for first, _, text in blocks if first.startswith("# ")}


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which pip has installed the package."""
    source, target = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("installed")
    for name, text in files().items():
        (source / name).parent.mkdir(exist_ok=True)
        (source / name).write_text(text, encoding="utf-8")
    options = ["--no-build-isolation", "--no-deps", "--no-index", "--disable-pip-version-check", "--quiet"]
    words = [sys.executable, "-m", "pip", "install", *options, "--target", str(target), str(source)]
    subprocess.run(words, check=True)
    return target


def test_the_package_is_short_and_imports_the_interface_alone() -> None:
    lines = [line for name, text in files().items() if name.endswith(".py") for line in text.splitlines()]
    assert len(files()) == 8
    assert sum(bool(line.strip()) for line in lines) <= 150
    imports = {line.split()[1] for line in lines if line.startswith("from mutabot")}
    assert imports == {f"mutabot.api.{name}" for name in ("faults", "processes", "reports", "values")}


def test_its_operator_executor_and_format_are_at_work(installed: Path, project: Path) -> None:
    # a process of its own, as nothing can raise the priority again
    words = ("-m", "mutabot", "-C", str(project), "run", "--nice", "3", "--json", "-o", "repeats=false")
    done = python(installed, *words)
    found = mutants(done)
    assert f"runs at priority {os.nice(0) + 3}\n" in done.stderr
    creep = found["creep"]
    assert creep["description"] == "robot.distance: reads result 0.155 m instead of 0.15 m"
    assert creep["rounds"][0]["verdict"] == "killed"
    told = mutabot(installed, project, "report", "--format", "survivors").stdout
    survivors = {name for name, mutant in found.items() if mutant["rounds"][0]["verdict"] == "survived"}
    assert len(told.splitlines()) == len(survivors) > 0


def test_the_examples_of_its_operator_do_what_they_say(installed: Path) -> None:
    code = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from operators.test_examples import operator, test_the_example_does_what_it_says\n"
        "for index in range(len(operator('creep').examples)):\n"
        "    test_the_example_does_what_it_says('creep', index)\n"
        "print(index + 1)"
    )
    done = python(installed, "-c", code, str(Path(__file__).parents[1]))
    assert (done.returncode, done.stdout) == (0, "2\n"), done.stderr


def test_the_lines_of_its_language_are_sites(installed: Path, steps: Path) -> None:
    found = mutants(mutabot(installed, steps, "run", "--json", "-o", "repeats=false", "--only", "*#2*skip"))
    assert found["skip"]["id"] == "mission.STEPS:steps:move#2:call:skip"
    assert found["skip"]["rounds"][0]["verdict"] == "killed"


def test_its_fault_of_the_world_is_at_work(installed: Path, tmp_path: Path) -> None:
    configuration = BELT["pyproject.toml"].replace("slippery = { at = 1.0 }\n", "\n")
    project = write(tmp_path, {**BELT, "pyproject.toml": configuration})
    found = mutants(mutabot(installed, project, "run", "--json"))
    end = found["slip"]["rounds"][0]
    assert (end["verdict"], end["engine"], end["acted"]) == ("killed", "fork", 1)
    assert end["test"] == "tests/test_mission.py::test_a_long_way"


def test_a_wrong_value_of_its_option_is_reported_before_anything_runs(installed: Path, project: Path) -> None:
    done = mutabot(installed, project, "run", "--nice", "20")
    assert (done.returncode, done.stderr) == (2, "mutabot: --nice 20: a number from 0 to 19\n")
