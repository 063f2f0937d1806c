"""The page on how mutabot is built is held to the code: its picture, every name in it, and its travels."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from campaign.project import write_project
from docs.travels import Called, calls_told, telling
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


def test_every_name_on_the_page_is_one_in_the_code() -> None:
    assert len(NAMES) > 50
    assert [name for name in NAMES if not is_named(name)] == []


def is_named(name: str) -> bool:
    try:
        return named(name) is not None
    except (ModuleNotFoundError, AttributeError):
        return False


def test_the_page_explains_few_words_with_those_of_users_and_none_twice() -> None:
    users = (ROOT / "docs" / "what-is-it.md").read_text(encoding="utf-8")
    ours, theirs = (re.findall(r"^\| \*\*(.+?)\*\*", text, re.MULTILINE) for text in (TEXT, users))
    assert len(ours) > 10
    assert len(theirs) > 4
    words = [*ours, *theirs]
    assert len(words) == len(set(words)) <= 25


MISSION = "def run(arm):\n    arm.move_by(0.25)\n"
TESTS = """
    import mission
    from robot import Arm

    def test_run():
        arm = Arm()
        mission.run(arm)
        assert arm.x > 0
"""
CONFIGURED = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-p", "telling", "-o", "pythonpath=."]
"""
REPORT, PLAN = "runtime.test_hooks.ForkedRun._report", "journal.journal.Journal.set_plan"
#: travel -> the engine of its campaign, and what is called only by the processes that go it, in their order
TRAVELS = {
    "A call through a mutant": ("replay", ["runtime.interception.active_mutant.MutatedSite.apply"]),
    "A fork": ("fork", [REPORT, "runtime.isolation.fork_parent.ForkParent._take_token"]),
    "An outcome on its way to the screen": ("fork", [REPORT, PLAN]),
    "From a vocabulary's line to a mutant": ("fork", [PLAN]),
}
#: steps that are on other ways as well: to be called after the step before is all that is asked of them
ON_MANY_WAYS = {
    "model.event_file.unsealed", "runtime.event_file.EventFile.send", "config.document.Document.read",
}  # fmt: skip


def steps(travel: str) -> list[str]:
    """The functions of a travel, in its order."""
    section = TEXT.partition(f"\n### {travel}\n")[2].partition("\n### ")[0]
    return _NAME.findall(section)


def calls_of(engine: str, folder: Path) -> list[Called]:
    """All calls of ours in a campaign of one mutant."""
    with calls_told() as (told, pipe):
        write_project(folder, MISSION, TESTS, configuration=CONFIGURED, more={"telling.py": telling(pipe)})
        assert main(["-C", str(folder), "run", "--engine", engine, "--only", "*:reverse"]) == 0
    return told


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], list[Called]]:
    return cache(lambda engine: calls_of(engine, tmp_path_factory.mktemp(engine)))


def test_the_page_has_these_travels() -> None:
    assert re.findall("^### (.*)$", TEXT, re.MULTILINE) == list(TRAVELS)


@pytest.mark.parametrize(
    "travel",
    [
        pytest.param(name, marks=pytest.mark.whole if engine == "replay" else ())
        for name, (engine, _) in TRAVELS.items()
    ],
)
def test_a_travel_goes_where_the_page_says_in_that_order(
    travel: str, told: Callable[[str], list[Called]]
) -> None:
    engine, marks = TRAVELS[travel]
    called = told(engine)
    left = steps(travel)
    assert len(left) > 10
    for mark in marks:
        process = [process for process, name in called if name == mark][-1]
        calls = [name for other, name in called if other == process]
        assert_in_order([step for step in left if step in calls], calls)
        left = [step for step in left if step not in calls]
    assert left == []  # no step is called by none of them


def assert_in_order(steps: list[str], calls: list[str]) -> None:
    """Each step is called for the first time after the one before it was."""
    before = -1
    for step in steps:
        first = calls.index(step, before + 1 if step in ON_MANY_WAYS else 0)
        assert first > before, f"{step} is called before what stands before it on the page"
        before = first
