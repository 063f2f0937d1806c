"""Tests put anything in the place of an operation, a class or a module: nothing of ours fails for it."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any
from unittest import mock

import pytest

from mutabot.runtime.targets.callables import Callables
from mutabot.runtime.targets.target import Finding, NotFoundError, is_named, named_class, resolve


class Base:
    def move_by(self, dx: float) -> float:
        return dx


class Arm(Base):
    """Its operation is inherited: the wrapper is the only thing of that name in it."""


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    module = ModuleType("robot_of_this_test")
    module.Arm = type("Arm", (Base,), {})  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, module.__name__, module)
    return module


def wrapped(module: ModuleType) -> tuple[Callables, list[Finding]]:
    told: list[Finding] = []
    callables = Callables(lambda target, finding: told.append(finding))
    callables.wrap(
        f"{module.__name__}:Arm.move_by", lambda wrapped, instance, args, kwargs: wrapped(*args, **kwargs)
    )
    return callables, told


def test_a_wrapper_that_a_test_has_deleted_is_gone(robot: Any) -> None:
    _, told = wrapped(robot)
    del robot.Arm.move_by
    assert told == []
    assert robot.Arm().move_by(1.0) == 1.0


def test_what_cannot_be_intercepted_for_any_reason_is_reported(robot: Any) -> None:
    class Odd(type):
        def __setattr__(cls, name: str, value: object) -> None:
            raise RuntimeError("not now")

    robot.Arm = Odd("Arm", (Base,), {})
    _, told = wrapped(robot)
    assert ["RuntimeError('not now')" in str(finding) for finding in told] == [True]


@pytest.mark.parametrize("instead", [None, mock.MagicMock(), 3, ModuleType("empty")])
def test_a_name_in_a_module_that_is_another_now_is_no_class_of_an_error(
    monkeypatch: pytest.MonkeyPatch, instead: Any
) -> None:
    monkeypatch.setitem(sys.modules, "robot_of_this_test", instead)
    found = named_class("robot_of_this_test:Refused")
    assert found is None or instead is not None
    assert not is_named(ValueError("no"), ["robot_of_this_test:Refused"])


def test_a_mock_in_the_place_of_a_class_lacks_what_it_lacks(robot: Any) -> None:
    robot.Arm = mock.Mock(spec=["x"])
    with pytest.raises(NotFoundError, match="has no 'move_by'"):
        resolve(robot, "Arm.move_by")
