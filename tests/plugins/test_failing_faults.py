"""What a fault's own code raises is an error of its mutant at any time; what the robot raises is not."""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from random import Random
from textwrap import dedent, indent
from types import ModuleType
from typing import Any
from unittest.mock import Mock

import pytest
from tests.plugins.test_faults import PACKAGE, PROJECT, by_parameter, write
from tests.plugins.test_plugins import ERRORS, mutabot

from mutabot.model import Mutant, Site
from mutabot.model.activation import Activation
from mutabot.runtime.active_fault import ActiveFault
from mutabot.runtime.activity import Activity
from mutabot.runtime.fault_runner import FaultRunner
from mutabot.runtime.interception.trace import Locator

#: a fault that stands around a command of the robot, and a helper of its own
FAULT = """
    import json
    from lab_helper import parsed
    from mutabot.api.faults import ActiveFault

    class Slow(ActiveFault):
        def start_test(self, test, random):
            self.call = self.data["call"]
            self.acts()

        def end_test(self):
            pass

        def wrong(self):
            self.acts(0, 1)
            return 1 + "1"

        def wrong_in_a_library(self):
            return json.loads("{")

        def wrong_in_a_helper(self):
            return parsed("x")

        def gives_up(self):
            raise SystemExit(3)

        def goes_on(self):
            return self.call()

        def lets_the_program_meet(self):
            raise self.raising(TimeoutError("no answer"))
    """
ROBOT = "def move():\n    raise OSError('out of reach')\n"


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    files = {"lab_fault.py": FAULT, "lab_helper.py": "def parsed(text):\n    return int(text)\n"}
    write(tmp_path / "site", {**files, "lab_robot.py": ROBOT})
    monkeypatch.syspath_prepend(tmp_path / "site")
    yield importlib.import_module("lab_fault")
    for name in ("lab_fault", "lab_helper", "lab_robot"):
        sys.modules.pop(name, None)


def placed(call: Any, told: list[str] | None = None) -> FaultRunner:
    mutant = Mutant(1, "world", "slow", Site.of_parameter("robot", "speed"), "", None, None, "", "")
    found = FaultRunner(Process(told if told is not None else []), lambda mutant: Random(1))
    found.take_on(mutant, Activation("lab_fault:Slow", {"call": call}))
    found.start_test()
    return found


@dataclass
class Process:
    """What a fault is given of its process, of which the tests are told when it acts."""

    told: list[str]
    round: int = 0
    test: str = "t"
    seconds: float | None = None

    def untracked(self) -> AbstractContextManager[None]:
        return nullcontext()

    def change_file(self, path: str, content: bytes) -> None:
        raise AssertionError("this one changes none")

    def acted(self) -> None:
        self.told.append("acted")


def met(fault: FaultRunner, name: str) -> str | None:
    """How the mutant's code failed, as far as the exception tells that a test meets."""
    own: ActiveFault | None = fault._fault
    try:
        getattr(own, name)()
    except BaseException as error:
        return fault.failure_in(error, {"lab_robot"}, Locator("/nowhere", (), ()))
    raise AssertionError("nothing was raised")


@pytest.mark.usefixtures("lab")
@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("wrong", "slow fails at work: TypeError"),
        ("wrong_in_a_library", "slow fails at work: JSONDecodeError"),
        ("wrong_in_a_helper", "slow fails at work: ValueError"),
        ("gives_up", "slow fails at work: SystemExit: 3"),
    ],
)
def test_what_its_code_raises_is_its_own_failure(name: str, told: str) -> None:
    assert (met(placed(None), name) or "").startswith(told)


@pytest.mark.usefixtures("lab")
def test_what_the_robot_raises_through_it_is_not() -> None:
    assert met(placed(importlib.import_module("lab_robot").move), "goes_on") is None
    assert met(placed(Mock(side_effect=RuntimeError("stop"))), "goes_on") is None


@pytest.mark.usefixtures("lab")
def test_what_it_lets_the_program_meet_is_not() -> None:
    assert met(placed(None), "lets_the_program_meet") is None


@pytest.mark.parametrize("error", ["ValueError('late')", "SystemExit(0)", "KeyboardInterrupt"])
def test_a_fault_that_cannot_be_taken_away_has_failed(lab: ModuleType, error: str) -> None:
    exec(f"def end_test(self): raise {error}", found := {})  # type: ignore[var-annotated]
    lab.Slow.end_test = found["end_test"]
    fault = placed(None)
    assert fault.activity.failure is None
    fault.end_test()
    assert (fault.activity.failure or "").startswith("slow cannot be taken away: ")


@pytest.mark.parametrize("activity", [None, Activity(hits="many")])  # type: ignore[arg-type]
def test_activity_that_cannot_be_read_is_a_failure(lab: ModuleType, activity: Any) -> None:
    fault = placed(None)
    own: Any = fault._fault
    own._activity = activity
    assert "slow cannot be asked what it did: TypeError" in (fault.activity.failure or "")


#: by its name, what a parameter's fault does wrong, and when
WRONG = {
    "gravity": "setattr(self.world, 'seconds_to_fall', lambda height: 1 + '1')",
    "colour": "raise SystemExit(0)",
    "mass": "self.end_test = lambda: 1 / 0",
    "wind": "self._activity = None",
}


@pytest.mark.whole
def test_such_a_fault_is_an_error_and_no_kill(tmp_path: Path) -> None:
    branches = "".join(f"if name == {name!r}:\n    {does}\n" for name, does in WRONG.items())
    inside = dedent(PACKAGE["toy_world_inside.py"]).replace(
        "        self.reached() if value", indent(branches, " " * 8) + "        self.reached() if value"
    )
    site = write(tmp_path / "site", {**PACKAGE, "toy_world_inside.py": inside})
    project = write(tmp_path / "project", {**PROJECT, "world.py": PROJECT["world.py"] + "wind = 0.0\n"})
    done = mutabot(site, project, "run", "--json", "-o", "repeats=false")
    assert done.returncode == ERRORS, done.stderr
    found = {name: mutant["rounds"][0] for name, mutant in by_parameter(json.loads(done.stdout)).items()}
    assert {name: end["verdict"] for name, end in found.items()} == dict.fromkeys(WRONG, "error")
    assert all("parameter " in end["message"] for end in found.values())
