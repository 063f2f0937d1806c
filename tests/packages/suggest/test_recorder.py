"""What a test notes is what could be read there, with the expression that reads it."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pytest

from mutabot_suggest import recorder


@dataclass
class Pose:
    x: float
    angles: tuple[float, ...]


class Loads(NamedTuple):
    left: bool


class Arm:
    def __init__(self) -> None:
        self.speed = 2.0

    def position(self) -> Pose:
        return Pose(1.5, (10.0, 20.0))

    def move(self) -> str:
        self.speed += 1.0
        return "moved"


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A module with an arm, as programs import it."""
    module: Any = ModuleType("noted_robot")
    module.Arm = type("Arm", (Arm,), {"move": Arm.move})
    monkeypatch.setitem(sys.modules, "noted_robot", module)
    return module  # type: ignore[no-any-return]


def fails() -> float:
    raise RuntimeError


async def later() -> float:
    return 1.0


def test_what_is_noted_can_be_evaluated_where_it_was_noted(robot: Any) -> None:
    arm = robot.Arm()
    names = {"arm": arm, "pose": Pose(0.5, (1.0,)), "_own": 1, "loads": Loads(left=True), "sys": sys}
    recorder.note(names, [("len('ab')", lambda: 2)], ["noted_robot:Arm.position"])
    found = recorder.values()
    assert found["len('ab')"] == 2
    assert found["loads.left"] is True
    assert found["arm.position().angles[1]"] == 20.0
    assert {text: eval(text, dict(names)) for text in found} == found
    assert not any(text.startswith(("_own", "sys")) for text in found)


class FakeBase:
    """A fake as suites write them: what it was told stands in its attributes."""

    def __init__(self) -> None:
        self.colour, self.horns, self.lift, self._secret = "blue", [True, False], Pose(0.25, ()), 1
        self.log = [("lift", 0.25)]


@pytest.mark.parametrize("held", ["base", "self.base"])
def test_what_a_fake_of_the_project_keeps_is_read_and_what_a_library_keeps_is_not(
    held: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = type("Case", (), {})()
    case.base = FakeBase()
    monkeypatch.chdir(Path(__file__).parent)
    recorder.note({"base": case.base} if held == "base" else {"self": case})
    assert recorder.values() == {
        f"{held}.colour": "blue",
        f"len({held}.horns)": 2,
        f"{held}.horns[0]": True,
        f"{held}.horns[1]": False,
        f"{held}.lift.x": 0.25,
    }
    monkeypatch.chdir("/proc")  # nothing of this is of the project then
    recorder.note({"base": case.base})
    assert recorder.values() == {}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("read", [fails, later, object])
def test_what_cannot_be_read_is_no_reading(read: Any) -> None:
    recorder.note({}, [("it()", read)])
    assert recorder.values() == {}


def test_the_date_of_a_run_is_no_reading_of_it() -> None:
    recorder.note({}, [("tag", lambda: {"value": 3.5, "ts": 1795942100.25, "count": 1795942100})])
    assert recorder.values() == {'tag["value"]': 3.5, 'tag["count"]': 1795942100}


def test_another_test_has_noted_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    recorder.note({"x": 1})
    assert recorder.values() == {"x": 1}
    monkeypatch.setenv("PYTEST_CURRENT_TEST", "another.py::test (call)")
    assert recorder.values() == {}


def test_what_notes_in_the_process_of_the_tests_loads_the_standard_library_alone() -> None:
    code = (
        "import sys; before = {*sys.modules}; import mutabot_suggest.recorder\n"
        "print(*{name.partition('.')[0] for name in {*sys.modules} - before} - sys.stdlib_module_names)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["mutabot_suggest"]
