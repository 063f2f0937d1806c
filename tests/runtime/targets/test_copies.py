"""Operations are shown, copied and pickled, alone and in other objects, as without anything around them."""

from __future__ import annotations

import copy
import pickle
import sys
from collections.abc import Callable
from functools import partial
from types import ModuleType
from typing import Any
from unittest.mock import create_autospec

import pytest

from mutabot.runtime.targets.callables import Callables

ROBOT = """
class Arm:
    def __init__(self):
        self.x = 0.0
        self.go = self.move_by

    def move_by(self, dx: float):
        'Go.'
        self.x += dx
        return self.x

    @classmethod
    def made(cls):
        return cls()

    @staticmethod
    def scaled(dx):
        return 2 * dx

def tool(on):
    return on
"""
NAMES = ("Arm.move_by", "Arm.made", "Arm.scaled", "tool")


@pytest.fixture
def calls() -> list[str]:
    """The names of the operations that are called."""
    return []


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch, calls: list[str]) -> ModuleType:
    """A module whose functions are wrapped."""
    module = ModuleType("robot_that_is_copied")
    exec(ROBOT, vars(module))  # the text above
    monkeypatch.setitem(sys.modules, module.__name__, module)
    callables = Callables(lambda target, finding: pytest.fail(f"{target}: {finding}"))

    def handle(wrapped: Callable[..., Any], instance: Any, args: Any, kwargs: Any) -> Any:
        calls.append(wrapped.__name__)
        return wrapped(*args, **kwargs)

    for name in NAMES:
        callables.wrap(f"{module.__name__}:{name}", handle)
    return module


def _pickled(value: Any) -> Any:
    return pickle.loads(pickle.dumps(value))


COPIES = pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, _pickled])


@COPIES
def test_functions_that_belong_to_no_object(
    robot: Any, calls: list[str], copied: Callable[[Any], Any]
) -> None:
    assert copied(robot.tool)(3) == 3
    assert copied(robot.Arm.scaled)(3) == 6
    assert copied(robot.Arm().scaled)(3) == 6
    assert copied(robot.Arm.made)().x == 0.0
    assert copied(robot.Arm.move_by)(robot.Arm(), 0.5) == 0.5
    assert calls == ["tool", "scaled", "scaled", "made", "move_by"]


@COPIES
def test_a_method_belongs_to_the_copy_of_its_object(
    robot: Any, calls: list[str], copied: Callable[[Any], Any]
) -> None:
    arm = robot.Arm()
    arm.move_by(0.5)
    again = copied(arm.move_by)
    assert (again.__self__ is arm) is (copied is copy.copy)
    assert again(0.25) == 0.75
    assert arm.x == (0.75 if copied is copy.copy else 0.5)
    assert calls == ["move_by", "move_by"]


@pytest.mark.parametrize("copied", [copy.deepcopy, _pickled])
def test_an_object_that_holds_its_own_method(robot: Any, copied: Callable[[Any], Any]) -> None:
    arm = robot.Arm()
    again = copied(arm)
    assert again.go.__self__ is again
    again.go(0.5)
    assert (arm.x, again.x) == (0.0, 0.5)


def test_a_wrapped_method_has_the_attributes_of_the_method(robot: Any) -> None:
    robot.Arm.__dict__["move_by"].__wrapped__.axis = "x"
    method = robot.Arm().move_by
    assert vars(method) == {"axis": "x"}
    assert (method.__doc__, method.__annotations__) == ("Go.", {"dx": "float"})
    assert create_autospec(robot.Arm(), instance=True).move_by(0.5) is not None


def test_what_is_wrapped_is_shown_as_it_is(robot: Any) -> None:
    for name in ("tool", "Arm.move_by", "Arm.scaled", "Arm.made"):
        shown = repr(eval(name, vars(robot)))
        assert shown.startswith(("<function ", "<bound method ")), shown
        assert name in shown
    assert "<function Arm.move_by " in repr(partial(robot.Arm.move_by, 1))
    assert repr(robot.Arm().move_by).startswith("<bound method Arm.move_by of <")
