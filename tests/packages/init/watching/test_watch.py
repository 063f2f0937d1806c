"""Watching the calls of a program changes nothing that the program can see."""

from __future__ import annotations

import ast
import builtins
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest.mock import MagicMock

import pytest

from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.observer import questions
from mutabot.runtime.program_text import call_sites
from mutabot.runtime.program_text.call_sites import CALLS
from mutabot_init.observations import Values
from mutabot_init.watching.values import look
from mutabot_init.watching.watch import Watch

ORDINARY = Path(__file__).parents[2] / "source" / "ordinary.py"


def run(source: str, name: str, monkeypatch: pytest.MonkeyPatch) -> tuple[ModuleType, Watch]:
    """A module whose calls are watched; its own file is part of the program."""
    watch = Watch((), lambda path: False if path == str(Path.cwd() / name) else None)
    monkeypatch.setattr(builtins, CALLS, call_sites._entries, raising=False)
    module = ModuleType(Path(name).stem)
    module.__dict__["__file__"] = name
    monkeypatch.setitem(sys.modules, module.__name__, module)
    tree = ast.parse(source, name)
    questions(watch, Locator(str(Path.cwd()), (name,), ())).change(tree, b"", name)
    exec(compile(tree, name, "exec"), vars(module))
    return module, watch


def test_an_ordinary_program_does_what_it_did(monkeypatch: pytest.MonkeyPatch) -> None:
    source = ORDINARY.read_text(encoding="utf-8")
    plain = ModuleType("ordinary")
    plain.__dict__["__file__"] = str(ORDINARY)
    monkeypatch.setitem(sys.modules, "ordinary", plain)
    exec(compile(source, str(ORDINARY), "exec", dont_inherit=True), vars(plain))
    expected = plain.results()
    watched, watch = run(source, str(ORDINARY), monkeypatch)
    assert repr(watched.results()) == repr(expected)
    assert watch.data().calls


def test_exceptions_and_private_names_pass_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    source = """
class Hidden:
    def __init__(self): self.__x = 3
    def __double(self): return 2 * self.__x
    def get(self): return self.__double()
class Heir(Hidden):
    def get(self): return super().get() + 1
def refuse(): return [].nothing
def fields(value):
    match value:
        case Hidden(): return 'hidden'
        case builtins.len: return 'len'
import builtins
"""
    module, _ = run(source, "own.py", monkeypatch)
    assert module.Heir().get() == 7
    assert module.fields(module.Hidden()) == "hidden"
    assert module.fields(len) == "len"
    with pytest.raises(AttributeError, match="'list' object has no attribute 'nothing'"):
        module.refuse()


def test_a_method_that_is_put_in_the_place_of_itself_is_called(monkeypatch: pytest.MonkeyPatch) -> None:
    source = """
class Command:
    def execute(self): return 1
def wrapped(command):
    execute = command.execute
    def other(self): return 1 + execute()
    other.__name__ = "execute"
    command.execute = other.__get__(command)
    return command.execute()
"""
    module, _ = run(source, "wrapped.py", monkeypatch)
    assert module.wrapped(module.Command()) == 2


def test_what_cannot_be_looked_at_disturbs_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    class Wild:
        @property
        def size(self) -> int:
            raise RuntimeError("do not look")

        def tolist(self) -> list[int]:
            raise RuntimeError("do not look")

        def __str__(self) -> str:
            raise RuntimeError("do not look")

        def set_x(self, value: Any) -> Any:
            return value

    monkeypatch.setattr(sys.modules[__name__], "WILD", Wild, raising=False)
    Wild.__qualname__ = "WILD"
    module, watch = run("def go(robot, value): return robot.set_x(value)\n", "own.py", monkeypatch)
    mock, wild = MagicMock(), Wild()
    assert module.go(wild, wild) is wild
    assert module.go(wild, mock) is mock
    assert module.go(mock, 1) is mock.set_x.return_value
    calls = {call.target: call.sites for call in watch.data().calls}
    assert calls == {f"{__name__}:WILD.set_x": {"own.py:1": 2}, "*:*.set_x": {"own.py:1": 1}}


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([1, 2, 1], {"a": [1, 2]}),
        ([True, 1], {"a": [True, 1]}),
        ([(0.1, 2)], {"a": [[0.1, 2]]}),
        ([{"x": 1, "y": {"z": "t"}}], {'a["x"]': [1], 'a["y"]["z"]': ["t"]}),
        ([([1, 2], 0.5, False)], {"a[0]": [[1, 2]], "a[1]": [0.5], "a[2]": [False]}),
        ([None], {}),
        ([list(range(100))], {"a": [list(range(16))]}),
        ([object()], {"a": []}),
        (["x" * 200], {"a": ["x" * 80]}),
    ],
)
def test_values_are_described_by_path(values: list[Any], expected: dict[str, list[Any]]) -> None:
    seen = Values()
    for value in values:
        look(seen, value, "a")
    assert {part.path: part.values for part in seen.parts.values()} == expected


@dataclass
class Node:
    value: int = 1
    next: Node | None = None


class Pose:
    def __init__(self) -> None:
        self.x, self.y, self._private = 1.0, [2.0, 3.0], 4.0


class World:
    def __init__(self) -> None:
        self.height, self.engine = 480, object()


def test_a_record_that_holds_itself_ends_somewhere() -> None:
    node = Node()
    node.next = node
    seen = Values()
    look(seen, node, "n")
    assert "n.next.value" in seen.parts


def test_only_objects_that_hold_plain_values_are_taken_apart() -> None:
    pose, world = Values(), Values()
    look(pose, Pose())
    look(world, World())
    assert {part.path: part.values for part in pose.parts.values()} == {".x": [1.0], ".y": [[2.0, 3.0]]}
    assert {part.path: part.type for part in world.parts.values()} == {"": "World"}


def test_a_loop_is_observed_for_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    source = """
class Line:
    speed = property(lambda self: 1.0)
    def send(self, value): return value
def other(value): return value
def run(times):
    line = Line()
    for value in range(times):
        line.send(value)
        speed = line.speed
    return speed + other(1)
"""
    monkeypatch.setattr("mutabot.runtime.observer._MOST_AT_A_SITE", 3)
    module, watch = run(source, "loop.py", monkeypatch)
    assert module.run(20) == 2.0
    counts = {"loop:Line.send": 3, "loop:Line.speed": 3, "loop:other": 1}
    assert {call.target: call.count for call in watch.data().calls} == counts
