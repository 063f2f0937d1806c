"""The package on docs/packages.md, built and installed as the page says: short, and at work."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.plugins.test_faults import write
from tests.plugins.test_faults_in_time import PROJECT as BELT
from tests.plugins.test_plugins import mutabot, mutants
from tests.plugins.test_plugins import project as project  # noqa: PLC0414  # a fixture

import pages

PAGE = Path(__file__).parents[2] / "docs" / "packages.md"


def files() -> dict[str, str]:
    """The files of the package by path: each block of the page whose first line names one."""
    blocks = (one.text.partition("\n") for one in pages.blocks(PAGE.read_text(encoding="utf-8")))
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


def test_the_package_has_a_hundred_and_twenty_lines_of_code() -> None:
    lines = [line for name, text in files().items() if name.endswith(".py") for line in text.splitlines()]
    assert len(files()) == 7
    assert 60 < sum(bool(line.strip()) for line in lines) <= 120


def test_its_operator_executor_and_format_are_at_work(installed: Path, project: Path) -> None:
    done = mutabot(installed, project, "run", "--nice", "3", "--json", "-o", "repeats=false")
    found = mutants(done)
    assert f"runs at priority {os.nice(0) + 3}\n" in done.stderr
    creep = found["creep"]
    assert creep["description"] == "robot.distance: reads result 0.155 m instead of 0.15 m"
    assert creep["rounds"][0]["verdict"] == "killed"
    told = mutabot(installed, project, "report", "--format", "survivors").stdout
    survivors = {name for name, one in found.items() if one["rounds"][0]["verdict"] == "survived"}
    assert len(told.splitlines()) == len(survivors) > 0


def test_its_fault_of_the_world_is_at_work(installed: Path, tmp_path: Path) -> None:
    configuration = BELT["pyproject.toml"].replace("slippery = { at = 1.0 }\n", "\n")
    project = write(tmp_path, {**BELT, "pyproject.toml": configuration})
    found = mutants(mutabot(installed, project, "run", "--json"))
    end = found["slip"]["rounds"][0]
    assert (end["verdict"], end["engine"], end["acted"]) == ("killed", "fork", 1)
    assert end["test"] == "tests/test_mission.py::test_a_long_way"


def test_a_wrong_value_of_its_option_is_told_before_anything_runs(installed: Path, project: Path) -> None:
    done = mutabot(installed, project, "run", "--nice", "20")
    assert (done.returncode, done.stderr) == (2, "mutabot: --nice 20: a number from 0 to 19\n")
