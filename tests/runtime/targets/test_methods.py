"""Operations are read, compared, kept and looked at as they are without anything around them."""

from __future__ import annotations

import copy
import gc
import inspect
import sys
import types
import weakref
from collections.abc import Callable
from functools import partialmethod
from types import ModuleType
from typing import Any
from unittest.mock import patch

import pytest

from mutabot.runtime.targets.callables import Callables

ROBOT = """
class Arm:
    def __init__(self):
        self.x = 0.0

    def move_by(self, dx, dy=0.0):
        self.x += dx
        return self.x

    @classmethod
    def made(cls, x=0.0):
        arm = cls()
        arm.x = x
        return arm

    @staticmethod
    def scaled(dx):
        return 2 * dx

class Tool:
    x = 0.0
"""
NAMES = ("Arm.move_by", "Arm.made", "Arm.scaled")


@pytest.fixture
def calls() -> list[tuple[Any, ...]]:
    """The calls of the operations: what it belongs to, and what it was given."""
    return []


@pytest.fixture(params=[False, True], ids=["plain", "wrapped"])
def is_wrapped(request: pytest.FixtureRequest) -> bool:
    """Whether the operations are wrapped: what holds of them holds of plain functions."""
    return bool(request.param)


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch, calls: list[tuple[Any, ...]], is_wrapped: bool) -> ModuleType:
    """A module with its operations."""
    module = ModuleType("robot_that_is_read")
    exec(ROBOT, vars(module))  # the text above
    monkeypatch.setitem(sys.modules, module.__name__, module)
    callables = Callables(lambda target, finding: pytest.fail(f"{target}: {finding}"))

    def handle(wrapped: Callable[..., Any], instance: Any, args: Any, kwargs: Any) -> Any:
        calls.append((instance, *args))
        return wrapped(*args, **kwargs)

    for name in NAMES if is_wrapped else ():
        callables.wrap(f"{module.__name__}:{name}", handle)
    return module


def test_a_weak_method_is_the_method_while_its_object_lives(robot: Any, calls: list[tuple[Any, ...]]) -> None:
    arm = robot.Arm()
    weak, same = weakref.WeakMethod(arm.move_by), weakref.WeakMethod(arm.move_by)
    method: Any = weak()
    assert (method(0.5), arm.x) == (0.5, 0.5)
    assert weak == same
    assert hash(weak) == hash(same)
    del arm, method
    calls.clear()  # they hold it
    gc.collect()
    assert weak() is None


def test_a_weak_method_of_a_class(robot: Any) -> None:
    method: Any = weakref.WeakMethod(robot.Arm.made)()
    assert method(0.5).x == 0.5


def test_a_function_of_a_class_lives_as_long_as_the_class(robot: Any) -> None:
    assert weakref.ref(robot.Arm.move_by)() is not None


def test_a_class_gives_the_same_function_each_time(robot: Any) -> None:
    arm, kind = robot.Arm(), robot.Arm
    assert kind.move_by is kind.move_by is vars(kind)["move_by"] is arm.move_by.__func__
    assert kind.scaled is arm.scaled
    assert kind.made.__func__ is vars(kind)["made"].__func__


def test_what_an_object_gives_is_a_method(robot: Any) -> None:
    arm = robot.Arm()
    for method in (arm.move_by, arm.made):
        assert type(method) is types.MethodType
        assert inspect.ismethod(method)
        assert [type(one) is type(arm) or callable(one) for one in gc.get_referents(method)] == [True, True]
    assert repr(arm.move_by) == f"<bound method Arm.move_by of {arm!r}>"
    match arm.move_by:
        case types.MethodType(__self__=owner):
            assert owner is arm
        case _:
            pytest.fail("no method")


def test_a_method_keeps_its_object_once(robot: Any) -> None:
    arm = robot.Arm()
    before = sys.getrefcount(arm)
    method = arm.move_by
    assert sys.getrefcount(arm) == before + 1
    assert method == arm.move_by


def test_what_stands_in_a_class_is_what_stood_there(robot: Any) -> None:
    kinds = [type(vars(robot.Arm)[name]) for name in ("made", "scaled")]
    assert kinds == [classmethod, staticmethod]
    assert [name for name, found in vars(robot.Arm).items() if callable(found) and name[0] != "_"] == [
        "move_by",
        "scaled",
    ]


def test_what_is_patched_comes_back(robot: Any) -> None:
    for name in ("move_by", "made", "scaled"):
        before = vars(robot.Arm)[name]
        with patch.object(robot.Arm, name, autospec=True):
            assert vars(robot.Arm)[name] is not before
        assert vars(robot.Arm)[name] is before


def test_a_method_can_be_bound_to_another_object(robot: Any) -> None:
    arm, other, tool = robot.Arm(), robot.Arm(), robot.Tool()
    arm.move_by.__get__(other)(0.25)
    types.MethodType(robot.Arm.move_by, arm)(0.5)
    vars(robot.Arm)["move_by"].__get__(tool)(0.75)
    robot.Tool.go = robot.Arm.move_by
    tool.go(1.0)
    partialmethod(robot.Arm.move_by, 2.0).__get__(other)()
    copy.deepcopy(arm.move_by)(9.0)
    assert (arm.x, other.x, tool.x) == (0.5, 2.25, 1.75)


def test_a_handler_gets_the_object_however_it_is_called(
    robot: Any, calls: list[tuple[Any, ...]], is_wrapped: bool
) -> None:
    arm = robot.Arm()
    arm.move_by(0.5)
    robot.Arm.move_by(arm, 0.5)
    list(map(robot.Arm.move_by, [arm], [0.5]))
    robot.Arm.made(0.5)
    arm.made(0.5)
    arm.scaled(0.5)
    expected = [(arm, 0.5)] * 3 + [(robot.Arm, 0.5)] * 2 + [(None, 0.5)]
    assert calls == (expected if is_wrapped else [])


def test_wrong_arguments_are_refused_in_the_same_words(robot: Any) -> None:
    arm = robot.Arm()
    for call, words in {
        robot.Arm.move_by: "missing 2 required positional arguments: 'self' and 'dx'",
        arm.move_by: "missing 1 required positional argument: 'dx'",
        lambda: arm.move_by(1, 2, 3): "takes from 2 to 3 positional arguments but 4 were given",
        lambda: arm.move_by(dz=1): "unexpected keyword argument 'dz'",
    }.items():
        with pytest.raises(TypeError, match=words):
            call()
