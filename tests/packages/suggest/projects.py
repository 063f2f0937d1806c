"""One robot program with tests in three styles, none of which looks at height or fingers."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from mutabot.cli.app import main

ROBOT = """
    import random

    class Arm:
        def __init__(self):
            self.x, self.z, self.closed = 0.0, 0.5, False

        def move_by(self, x=0.0, z=0.0):
            self.x += x + random.gauss(0.0, 0.0005)
            self.z += z + random.gauss(0.0, 0.0005)

        def grip(self, closed):
            self.closed = closed

        def state(self):
            return {"x": self.x, "z": self.z, "closed": self.closed}
"""
PROGRAM = """
    def by_function(arm):
        arm.grip(False)
        arm.move_by(x=0.3, z=-0.1)
        arm.grip(True)

    def by_case(arm):
        arm.move_by(x=0.3, z=-0.1)

    def by_steps(arm):
        arm.move_by(x=0.3, z=-0.1)
"""
VOCABULARY = """
    [[probe]]
    call = "robot:Arm.state"
    tolerance = 0.001

    [[operation]]
    call = "robot:Arm.move_by"
    arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    arguments.z = { kind = "translation", axis = "z", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:Arm.grip"
    arguments.closed = { kind = "opening", values = [false, true] }
"""
PYTEST = """
    import mission
    import pytest
    from robot import Arm


    @pytest.fixture
    def arm():
        return Arm()


    @pytest.mark.parametrize("closed", [True, False])
    def test_goes_along_the_rail(arm, closed):
        arm.closed = closed
        mission.by_function(arm)
        assert arm.x == pytest.approx(0.3, abs=0.05)
"""
UNITTEST = """
    import unittest

    import mission
    from robot import Arm


    class MissionTest(unittest.TestCase):
        def setUp(self):
            self.arm = Arm()

        def test_goes_along_the_rail(self):
            mission.by_case(self.arm)
            self.assertAlmostEqual(self.arm.x, 0.3, delta=0.05)

        def test_stands_still(self):
            self.assertEqual(self.arm.x, 0.0)
"""
SCENARIO = """
    Feature: The rail

      Background:
        Given an arm

      @slow
      Scenario: Another one
        When nothing happens

      Scenario: It goes along the rail
        When the program has run
        Then it is at 0.3 m
"""
STEPS = """
    import mission
    import pytest
    from pytest_bdd import given, parsers, scenarios, then, when
    from robot import Arm

    scenarios("rail.feature")


    @given("an arm", target_fixture="arm")
    def an_arm() -> Arm:
        return Arm()


    @when("nothing happens")
    def nothing_happens() -> None:
        pass


    @when("the program has run")
    def the_program_has_run(arm: Arm) -> None:
        mission.by_steps(arm)


    @then(parsers.parse("it is at {place:f} m"))
    def it_is_at(arm: Arm, place: float) -> None:
        assert arm.x == pytest.approx(place, abs=0.05)
"""


#: tests by their files; each file runs a function of the program that no other runs
TESTS = {
    "test_functions.py": PYTEST,
    "test_cases.py": UNITTEST,
    "test_steps.py": STEPS,
    "rail.feature": SCENARIO,
}
STYLES = {"test_functions.py": "pytest", "test_cases.py": "unittest", "test_steps.py": "other"}
#: what campaigns load, which is less than all that is installed
_PYTEST = "[pytest]\npythonpath = .\nmarkers = slow\naddopts = -p pytest_bdd.plugin\n"
_SETTINGS = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\nprivate_files = false\n'


def make(folder: Path, tests: Mapping[str, str] = TESTS, program: str = PROGRAM) -> Path:
    """A project on disk: the robot, its program and these tests."""
    texts = {"robot.py": ROBOT, "robot.toml": VOCABULARY, "mutabot.toml": _SETTINGS, "pytest.ini": _PYTEST}
    texts["mission.py"] = program
    texts |= {f"tests/{name}": text for name, text in tests.items()}
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(dedent(text).lstrip("\n"))
    return folder


def found_by(command: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """What a command prints as JSON."""
    capsys.readouterr()
    assert main([*command, "--json"]) == 0, capsys.readouterr().err
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def patched(folder: Path, diff: str) -> None:
    """The project with a diff applied, as a user applies it."""
    subprocess.run(["patch", "-p1", "-s"], cwd=folder, input=diff, text=True, check=True)


def passes(folder: Path, *tests: str) -> tuple[int, int]:
    """How many tests of a project fail and pass with plain pytest, warnings being errors."""
    command = [sys.executable, "-m", "pytest", "-q", "-W", "error", "-p", "no:cacheprovider", *tests]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    counts = {word: int(number) for number, word in re.findall(r"(\d+) (failed|passed|errors?)", done.stdout)}
    assert not {"error", "errors"} & counts.keys(), done.stdout
    return counts.get("failed", 0), counts.get("passed", 0)
