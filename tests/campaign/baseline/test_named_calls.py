"""Calls of operations in text that nobody runs: found by their names, told apart by what the text says."""

from __future__ import annotations

from textwrap import dedent

import pytest

from mutabot.campaign.baseline.named_calls import KnownCalls, NamedCall, calls_in
from mutabot.model import Operation, Pattern

MOVE = Operation("robot:Arm.move")
OPEN = Operation("robot:Gripper.open")
HOME = Operation("robot:home")
ANY = Operation("*:*.stop", kind="methods")
SEND = Operation(
    "link:Link.send",
    message="text",
    patterns=(Pattern("lift/{height:g}"), Pattern("turn/{angle:g}")),
)


def found(
    text: str, *, reached: dict[str, set[str]] | None = None, alone: tuple[str, ...] = ()
) -> list[NamedCall]:
    operations = {"move": [MOVE], "open": [OPEN], "home": [HOME], "stop": [ANY], "send": [SEND]}
    known = KnownCalls(operations, {"cell", "mission"}, reached or {}, alone)
    return list(calls_in(dedent(text), "mission.py", known))


@pytest.mark.parametrize(
    ("text", "function"),
    [
        ("def f(arm):\n    arm.move(1)", "f"),
        ("class Cell:\n    def go(self):\n        self.arm.move(1)", "Cell.go"),
        ("from robot import Arm\ndef f():\n    arm = Arm()\n    arm.move(1)", "f"),
        ("from robot import Arm\ndef f(arm: Arm):\n    arm.move(1)", "f"),
        ("def f(arm):\n    def inner():\n        arm.move(1)", "f.<locals>.inner"),
        ("f = lambda arm: arm.move(1)", "<lambda>"),
        ("def f(arms):\n    return [arm.move(1) for arm in arms]", "f"),
        ("async def f(arm):\n    await arm.move(1)", "f"),
        ("import robot\nrobot.home()", "<module>"),
        ("from robot import home\ndef f():\n    home()", "f"),
        ("from robot import home as go\ndef f():\n    go()", "f"),
        ("from .parts import arm\ndef f():\n    arm.move(1)", "f"),
        ("from cell.parts import arm\ndef f():\n    arm.move(1)", "f"),
        ("class Mine(Arm):\n    def far(self):\n        self.move(1)", "Mine.far"),
        ("class Mine(Arm):\n    def move(self, x):\n        super().move(x)", "Mine.move"),
        ("import os\ndef f():\n    os.stop()", "f"),
        ("if __name__ == '__main__':\n    arm.move(1)", "<module>"),
    ],
)
def test_a_call_of_the_name_counts(text: str, function: str) -> None:
    (call,) = found(text)
    assert call.doubt == ""
    assert call.site.span.function == function


@pytest.mark.parametrize(
    "text",
    [
        "def f(path):\n    open(path)",
        "import os\ndef f():\n    os.open('x', 0)",
        "from shutil import move\ndef f():\n    move('a', 'b')",
        "import shutil as arm\ndef f():\n    arm.move('a', 'b')",
        "class Cell:\n    def move(self):\n        pass\n    def go(self):\n        self.move()",
        "def home():\n    pass\ndef f():\n    home()",
        "if TYPE_CHECKING:\n    arm.move(1)",
        "def f(arm: 'arm.move(1)'):\n    pass",
        "def f():\n    'text'.move(1)",
    ],
)
def test_what_the_text_says_to_be_something_else_is_left_out(text: str) -> None:
    assert found(text) == []


@pytest.mark.parametrize(
    ("text", "doubt"),
    [
        ("import zipfile\ndef f():\n    file = zipfile.ZipFile('x')\n    file.open('y')", "zipfile.ZipFile"),
        ("from pathlib import Path\ndef f(path: Path):\n    path.open()", "pathlib.Path"),
        (
            "import zipfile\nclass C:\n    def __init__(self):\n        self.file = zipfile.ZipFile('x')\n"
            "    def f(self):\n        self.file.open('y')",
            "zipfile.ZipFile",
        ),
        ("def f(move):\n    move(1)", "a variable that is called"),
        ("def f(link, text):\n    link.send(text)", "depends on what is computed"),
    ],
)
def test_what_may_be_something_else_is_in_doubt(text: str, doubt: str) -> None:
    (call,) = found(text)
    assert doubt in call.doubt


def test_what_tests_reach_shows_what_the_same_text_is() -> None:
    text = "from pathlib import Path\ndef f(path: Path):\n    path.open()"
    assert found(text, reached={"path.open": {OPEN.target}})[0].doubt == ""
    assert "not an operation" in found("def f(file):\n    file.open()", alone=("file.open",))[0].doubt


@pytest.mark.parametrize("argument", ["'lift/3'", "f'lift/{height}'", "text='lift/3'"])
def test_a_command_is_identified_by_the_text_that_stands_there(argument: str) -> None:
    (call,) = found(f"def f(link, height):\n    link.send({argument})")
    assert (call.pattern, call.doubt) == ("lift/{height:g}", "")


def test_of_operations_with_one_name_the_class_or_the_arguments_decide() -> None:
    other = Operation("robot:Belt.move")
    known = KnownCalls({"move": [MOVE, other]}, (), {}, ())
    text = "from robot import Belt\ndef f():\n    belt = Belt()\n    belt.move(1)"
    assert [call.operation for call in calls_in(text, "mission.py", known)] == [other.target]
