"""Who is called, where only docstrings, mocks or patches tell."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any
from unittest import mock

import pytest

from mutabot.api.processes import CallOrigin
from mutabot_init.observations import WatchedCallable
from mutabot_init.watching.callee import Callee, replaced_method
from mutabot_init.watching.watch import Watch

OVERLOADED = """moveJ(*args, **kwargs)
Overloaded function.

1. moveJ(self: rtde.Control, path: list[list[float]], asynchronous: bool = False) -> bool

Move along a path.

2. moveJ(self: rtde.Control, q: list[float], speed: float = 1.05, mode: rtde.Mode = <Mode.A: 0>) -> bool

Move to a joint position.
"""
UNNAMED = """setPayload(self: rtde.Control, arg0: float, arg1: list[float]) -> bool

Parameter ``mass``:
    Mass in kilograms

Parameter ``cog``:
    Center of gravity
"""


class Native:
    """As pybind11 makes methods: no signature but in the docstring."""

    def __init__(self, doc: str) -> None:
        self.__doc__ = doc


@pytest.mark.parametrize(
    ("name", "doc", "expected"),
    [
        ("moveJ", OVERLOADED, ["q", "speed", "mode"]),
        ("setPayload", UNNAMED, ["mass", "cog"]),
        ("stop", "stop(*args, **kwargs)", None),
        ("stop", "Stop at once.", None),
    ],
)
def test_docstrings_of_native_methods_name_arguments(name: str, doc: str, expected: list[str] | None) -> None:
    callee = Callee(f"rtde:Control.{name}", Native(doc), type("Control", (), {}), "")
    assert (list(callee.signature.parameters) if callee.signature else None) == expected
    assert callee.is_documented == (expected is not None)


class ArmOfTest:
    def move_by(self, dx: float, speed: float = 0.1) -> None: ...


def lift(height: float) -> None: ...


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A module with a class and a function."""
    module: Any = ModuleType("robot_of_test")
    monkeypatch.setattr(ArmOfTest, "__module__", module.__name__)
    module.ArmOfTest, module.lift = ArmOfTest, lift
    monkeypatch.setitem(sys.modules, module.__name__, module)
    return module  # type: ignore[no-any-return]


def make(watch: Watch, value: Any, name: str, *args: Any) -> None:
    """Call a method or a module's function as the program does."""
    watch.called(name, getattr(value, name), value, CallOrigin("mission.py", 1, is_test=False))(*args)


def seen(value: Any, name: str, *args: Any) -> WatchedCallable:
    """What is seen of the program's call of a method or of a module's function."""
    watch = Watch((), lambda path: None)
    make(watch, value, name, *args)
    (call,) = watch.data().calls
    return call


def test_a_mock_of_a_patched_class_stands_for_the_class(robot: Any) -> None:
    with mock.patch.object(robot, "ArmOfTest"):
        monkeys = ModuleType("program_of_test")
        monkeys.__dict__["ArmOfTest"] = ArmOfTest  # another module has it under its name
        with mock.patch.dict(sys.modules, {monkeys.__name__: monkeys}):
            call = seen(robot.ArmOfTest(), "move_by", 0.5)
    assert (call.target, list(call.arguments), call.stands_in) == (
        "robot_of_test:ArmOfTest.move_by",
        ["dx", "speed"],
        True,
    )


def test_a_mock_with_a_specification_stands_for_the_class_even_while_it_is_patched(robot: Any) -> None:
    arm = mock.create_autospec(ArmOfTest, instance=True)
    with mock.patch.object(robot, "ArmOfTest", return_value=arm):
        call = seen(robot.ArmOfTest(), "move_by", 0.5)
    assert call.target == "robot_of_test:ArmOfTest.move_by"
    assert call.arguments["dx"].parts["dx"].values == [0.5]


def test_a_patched_function_is_what_its_place_says(robot: Any) -> None:
    with mock.patch.object(robot, "lift"):
        call = seen(robot, "lift", 0.25)
    assert (call.target, call.stands_in, call.problem) == ("robot_of_test:lift", True, "")


def test_a_class_in_a_function_has_no_name_to_stand_for() -> None:
    class Local:
        def go(self) -> None: ...

    assert replaced_method(Local, "go") is None


def test_a_real_call_shows_more_than_the_mock_before_it(robot: Any) -> None:
    watch = Watch((), lambda path: None)
    with mock.patch.object(robot, "lift"):
        make(watch, robot, "lift", 0.25)
    lift.__module__, before = robot.__name__, lift.__module__
    try:
        make(watch, robot, "lift", 0.5)
    finally:
        lift.__module__ = before
    (call,) = watch.data().calls
    assert (call.sites, list(call.arguments)) == ({"mission.py:1": 2}, ["height"])
