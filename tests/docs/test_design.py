"""The page on how mutabot is built is held to the code: its picture, every name in it, and its travels."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

from campaign.project import write_project
from docs.travels import calls_told, telling
from mutabot.cli.app import main
from rooms import SOURCE

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
_ROOMS = sorted({path.stem for path in SOURCE.iterdir() if path.suffix in {"", ".py"}} - {"__pycache__"})
#: a name in code that begins with one of our rooms
_NAME = re.compile(rf"`((?:{'|'.join(_ROOMS)})\.[A-Za-z_.]+)`")
NAMES = sorted({found for found in _NAME.findall(TEXT) if not found.endswith(".py")})


def test_the_picture_of_the_rooms_is_up_to_date() -> None:
    script = ROOT / "tools" / "make_design_page.py"
    done = subprocess.run([sys.executable, str(script), "--check"], check=False)
    assert done.returncode == 0, "run python tools/make_design_page.py"


def named(name: str) -> object:
    """What such a name stands for. Raises AttributeError or ModuleNotFoundError."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        module = ".".join(["mutabot", *parts[:count]])
        if (SOURCE / Path(*parts[:count])).is_dir() or (SOURCE / Path(*parts[:count])).with_suffix(
            ".py"
        ).is_file():
            found: object = importlib.import_module(module)
            for attribute in parts[count:]:
                found = getattr(found, attribute)
            return found
    raise ModuleNotFoundError(name)


@pytest.mark.parametrize("name", NAMES)
def test_every_name_on_the_page_is_one_in_the_code(name: str) -> None:
    assert named(name) is not None


MISSION = "def run(arm):\n    arm.move_by(0.25)\n"
TESTS = """
    import mission
    from robot import Arm

    def test_run():
        arm = Arm()
        mission.run(arm)
        assert arm.x > 0
"""
#: files are not private: else the pipe would be another one inside
CONFIGURED = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-p", "telling", "-o", "pythonpath=."]
    private_files = false
"""
#: travel -> the engine of the campaign that goes it
TRAVELS = {
    "A call through a mutant": "replay",
    "A branch": "branch",
    "An outcome on its way to the screen": "branch",
    "From a vocabulary's line to a mutant": "branch",
}


def steps(travel: str) -> list[str]:
    """The functions of a travel, in its order."""
    section = TEXT.partition(f"\n### {travel}\n")[2].partition("\n### ")[0]
    return _NAME.findall(section)


def calls_of(engine: str, folder: Path) -> list[str]:
    """All calls of ours in a campaign of one mutant."""
    project, pipe = folder / "project", folder / "calls"
    write_project(project, MISSION, TESTS, configuration=CONFIGURED, more={"telling.py": telling(pipe)})
    with calls_told(pipe) as told:
        assert main(["-C", str(project), "run", "--engine", engine, "--only", "*:reverse"]) == 0
    return told


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    return {engine: calls_of(engine, tmp_path_factory.mktemp(engine)) for engine in ("replay", "branch")}


def test_the_page_has_these_travels() -> None:
    assert re.findall("^### (.*)$", TEXT, re.MULTILINE) == list(TRAVELS)


@pytest.mark.parametrize("travel", TRAVELS)
def test_a_travel_goes_where_the_page_says_in_that_order(travel: str, told: dict[str, list[str]]) -> None:
    assert len(steps(travel)) > 5
    calls = iter(told[TRAVELS[travel]])
    for step in steps(travel):
        assert step in calls, f"{step} is not called, or not after what stands before it"
