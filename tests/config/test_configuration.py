"""Configurations that load, and what they mean."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import ValidationError

from mutabot.config.configuration import Configuration, load_configuration

GOOD = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\n'


@pytest.fixture
def project(tmp_path: Path) -> Path:
    for name in (
        "mission.py",
        "src/b.py",
        "src/a.py",
        "src/c.txt",
        "src/__pycache__/d.py",
        "tests/sensors.py",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    return tmp_path


def loaded(project: Path, text: str) -> Configuration:
    (project / "mutabot.toml").write_text(text)
    return load_configuration(project)


def test_what_is_not_said_has_a_default(project: Path) -> None:
    configuration = loaded(project, GOOD)
    assert configuration == Configuration(
        program=("mission.py",),
        oracle=(),
        tests=("tests",),
        vocabulary=("robot.toml",),
        rounds=1,
        seed=1,
        jobs=None,
        timeout_factor=10,
        timeout_seconds=None,
        memory=4_000_000_000,
        unstable_limit=0.1,
        timeout_limit=1.0,
        error_limit=0.0,
        min_score=None,
        pytest_args=(),
        root=project.resolve(),
        file="mutabot.toml",
    )


def test_everything_may_be_said_in_pyproject(project: Path) -> None:
    (project / "pyproject.toml").write_text(
        "[project]\nname = 'a'\n[tool.mutabot]\n"
        + GOOD
        + 'oracle = ["tests/sensors.py"]\ntests = ["tests/sensors.py::test_a", "-k", "not slow"]\n'
        + "rounds = 5\nseed = 7\njobs = 2\ntimeout_factor = 3\ntimeout_seconds = 2.5\n"
        + 'memory = "1.5 GB"\nunstable_limit = 0\ntimeout_limit = 0.5\nerror_limit = 0.25\nmin_score = 80\n'
        + 'pytest_args = ["-q"]\n'
    )
    configuration = load_configuration(project)
    assert configuration.file == "pyproject.toml"
    assert configuration.oracle == ("tests/sensors.py",)
    assert configuration.tests == ("tests/sensors.py::test_a", "-k", "not slow")
    assert (configuration.rounds, configuration.seed, configuration.jobs) == (5, 7, 2)
    assert (configuration.memory, configuration.min_score) == (1_500_000_000, 80)
    assert (configuration.timeout_limit, configuration.error_limit) == (0.5, 0.25)


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        (["src"], ("src",)),
        (["./src/", "mission.py"], ("mission.py", "src")),
        (["src/*.py"], ("src/a.py", "src/b.py")),
        (["**/*.py"], ("mission.py", "src/a.py", "src/b.py", "tests/sensors.py")),
        (["*"], ("mission.py", "src", "tests")),
        (["src/b.py", "src/*.py"], ("src/a.py", "src/b.py")),
        (["."], (".",)),
    ],
)
def test_globs_are_expanded_and_folders_kept(
    program: list[str], expected: tuple[str, ...], project: Path
) -> None:
    assert loaded(project, f"program = {program}\nvocabulary = ['robot']").program == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("512 MB", 512_000_000),
        ("4GB", 4_000_000_000),
        ("1 GiB", 2**30),
        ("256 mib", 2**28),
        ("0.5 TB", 500_000_000_000),
    ],
)
def test_memory_is_written_with_its_unit(text: str, expected: int, project: Path) -> None:
    assert loaded(project, GOOD + f"memory = '{text}'").memory == expected


def test_a_configuration_does_not_change(project: Path) -> None:
    with pytest.raises(ValidationError):
        loaded(project, GOOD).rounds = 2  # type: ignore[misc]  # that is the point


def test_a_pyproject_of_others_does_not_matter(project: Path) -> None:
    (project / "pyproject.toml").write_text("[project]\nname = 'a'\n")
    assert loaded(project, GOOD).file == "mutabot.toml"
