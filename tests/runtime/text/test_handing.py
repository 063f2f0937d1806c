"""Operations that are handed on without being called, and what stands in their place."""

from __future__ import annotations

import copy
import inspect
import pickle
import sys
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace
from typing import Any
from unittest.mock import AsyncMock, Mock, call, create_autospec

import pytest

from mutabot.model import Mutant, Role, Site
from mutabot.model.events import Remark
from tests.runtime.stage import Make, Stage, take_away

ROBOT = """
    class Arm:
        def move_by(self, dx, speed=1.0):
            self.x = dx

    def tool(on):
        return on
"""
PROGRAM = """
    from copy import deepcopy
    from functools import partial, partialmethod
    from robot import tool

    def alias(arm):
        go = arm.move_by
        go(0.5)

    def prepared(arm):
        partial(arm.move_by, speed=2.0)(0.5)

    def each(arm):
        list(map(arm.move_by, [0.5]))

    def by_name(arm):
        getattr(arm, "move_" + "by")(0.5)

    def hand(arm):
        return arm.move_by

    def given(take, arm):
        return take(arm.move_by)

    def given_again(take, arm):
        return take(arm.move_by)

    def kept(arm):
        return [one for one in (arm.move_by,)][0]

    def function(take):
        return take(tool)

    def looked_at(arm):
        return arm.move_by == 1, arm.move_by is arm.move_by, arm.move_by.__name__, f"{arm.move_by}"

    def get(*given):
        return getattr(*given)

    def borrowed(kind):
        class Other:
            move_by = kind.move_by
        other = Other()
        other.move_by(0.5)
        return other.x

    def prepared_in_a_class(kind):
        class Other(kind):
            far = partialmethod(kind.move_by, 0.5, speed=2.0)
        other = Other()
        other.far()
        return other.x

    def made_late(kind):
        other = type("Other", (), {"go": kind.move_by})()
        other.go(0.5)
        return other.x

    def bound_to(kind):
        other = kind()
        kind.move_by.__get__(other)(0.5)
        return other.x

    def through_the_class(kind):
        other = kind()
        list(map(kind.move_by, [other], [0.5]))
        return other.x

    def copied(kind):
        other = kind()
        other.go = other.move_by
        again = deepcopy(other)
        again.go(0.5)
        return again.x if not hasattr(other, "x") else other

    def data(arm):
        move_by = arm.move_by
        return [move_by, arm.move_by]
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Arm.move_by"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:tool"
    arguments.on = { kind = "output", values = [false, true] }
"""


@pytest.fixture
def stage(make_stage: Make) -> Stage:
    return make_stage(ROBOT, PROGRAM, VOCABULARY)


def _fake(stage: Stage) -> Any:
    class Fake(stage.load_robot().Arm):  # type: ignore[misc, name-defined]
        def move_by(self, distance: float, speed: float = 1.0) -> None:
            self.told = distance

    return Fake()


def _arms(stage: Stage) -> dict[str, Any]:
    arm = stage.load_robot().Arm
    return {
        "the robot": arm(),
        "a fake": _fake(stage),
        "a mock": Mock(),
        "an autospec": create_autospec(arm, instance=True),
        "a mock around it": Mock(wraps=arm()),
        "a stub": SimpleNamespace(move_by=Mock()),
    }


ARMS = ("the robot", "a fake", "a mock", "an autospec", "a mock around it", "a stub")


@pytest.mark.parametrize("what", ARMS)
@pytest.mark.parametrize("function", ["alias", "prepared", "each", "by_name"])
def test_a_call_is_seen_once_where_it_is_made(stage: Stage, function: str, what: str) -> None:
    session = stage.session()
    stage.load_program()
    stage.run(session, function, _arms(stage)[what])
    ((index, written, *_),) = session.recorder.trace
    assert written == {"dx": 0.5}
    assert session.recorder.sites[index].span.function == function


@pytest.mark.parametrize(
    "function", ["borrowed", "prepared_in_a_class", "made_late", "bound_to", "through_the_class", "copied"]
)
def test_a_function_of_a_class_belongs_to_the_object_that_it_is_called_with(
    stage: Stage, function: str
) -> None:
    session = stage.session()
    stage.load_program()
    kind = stage.load_robot().Arm
    assert stage.run(session, function, kind) == 0.5
    ((index, written, *_),) = session.recorder.trace
    assert written == {"dx": 0.5}
    assert session.recorder.sites[index].span.function == function


@pytest.mark.parametrize("what", ARMS)
def test_in_a_thread_it_belongs_to_the_call_that_it_was_given_to(stage: Stage, what: str) -> None:
    session = stage.session()
    stage.load_program()
    arm = _arms(stage)[what]
    with ThreadPoolExecutor(1) as pool:
        for function in ("given", "given_again"):
            stage.run(session, function, lambda action: pool.submit(action, 0.5).result(), arm)
    seen = [session.recorder.sites[index].span.function for index, *_ in session.recorder.trace]
    assert seen == ["given", "given_again"]


def test_so_does_a_function_of_the_robot(stage: Stage) -> None:
    session = stage.session()
    stage.load_program()
    with ThreadPoolExecutor(1) as pool:
        stage.run(session, "function", lambda action: pool.submit(action, True).result())
    ((index, written, *_),) = session.recorder.trace
    assert (session.recorder.sites[index].span.function, written) == ("function", {"on": True})


def test_a_mutant_changes_what_a_mock_is_given_in_a_thread(stage: Stage) -> None:
    def take(action: Callable[..., Any]) -> None:
        with ThreadPoolExecutor(1) as pool:
            pool.submit(action, 0.5).result()

    session = stage.session()
    stage.run(session, "given", take, Mock())
    take_away(session)
    (seen,) = stage.sites()
    site = Site(seen.span, "take", 1, Role.PROGRAM)
    mutant = Mutant(1, "robot", "reverse", site, seen.operation, None, "dx", "", "", None)
    arm = Mock()
    del sys.modules[stage.program_name]
    stage.run(stage.session(mutant), "given", take, arm)
    assert arm.mock_calls == [call.move_by(-0.5)]


def test_a_mock_stays_the_object_that_it_is(stage: Stage) -> None:
    session = stage.session()
    stage.load_program()
    arm = Mock()
    assert stage.run(session, "hand", arm) is arm.move_by
    assert stage.run(session, "kept", arm) is arm.move_by
    assert stage.run(session, "function", lambda action: action) is stage.load_robot().tool
    is_equal, is_same, *_ = stage.run(session, "looked_at", Mock(move_by=Mock(__name__="move")))
    assert (is_equal, is_same) == (False, True)


def test_what_is_handed_on_in_a_wrapper_looks_and_acts_like_it(stage: Stage) -> None:
    session = stage.session()
    stage.load_program()
    fake = _fake(stage)
    action = stage.run(session, "hand", fake)
    assert action == fake.move_by
    assert hash(action) == hash(fake.move_by)
    assert (action.__name__, action.__self__) == ("move_by", fake)
    assert inspect.signature(action) == inspect.signature(fake.move_by)
    assert inspect.ismethod(action)
    assert weakref.WeakMethod(action)() == fake.move_by
    assert copy.deepcopy({"go": action})["go"].__self__ is not fake
    assert copy.copy(action) is action
    robot = stage.load_robot().Arm()
    again = pickle.loads(pickle.dumps(stage.run(session, "hand", robot)))
    assert again.__name__ == "move_by"


def test_attributes_are_got_by_name_as_ever(stage: Stage) -> None:
    session = stage.session()
    stage.load_program()
    assert stage.run(session, "get", SimpleNamespace(move_by=3), "move_by") == 3
    assert stage.run(session, "get", None, "move_by", "nothing") == "nothing"
    with pytest.raises(AttributeError, match="'NoneType' object has no attribute 'move_by'"):
        stage.run(session, "get", None, "move_by")
    with pytest.raises(TypeError):
        stage.run(session, "get", None)


def test_plain_data_of_an_operations_name_stays(stage: Stage) -> None:
    session = stage.session()
    stage.load_program()
    value: list[int] = []
    assert all(
        value_handed is value for value_handed in stage.run(session, "data", SimpleNamespace(move_by=value))
    )
    with pytest.raises(AttributeError, match="move_by"):
        stage.run(session, "hand", object())


def test_coroutine_functions_are_known_as_such(stage: Stage) -> None:
    session = stage.session()
    stage.load_program()

    class Fake(stage.load_robot().Arm):  # type: ignore[misc, name-defined]
        async def move_by(self, dx: float) -> None:
            """Stay."""

    for arm in (Fake(), Mock(move_by=AsyncMock())):
        assert inspect.iscoroutinefunction(stage.run(session, "hand", arm))


def test_check_says_what_cannot_be_placed(stage: Stage) -> None:
    session = stage.session(inspect=True)
    stage.load_program()
    arm = Mock()
    session.start_test("test")
    for function in ("hand", "kept"):
        action = stage.run(session, function, arm)
    with ThreadPoolExecutor(1) as pool:
        pool.submit(action, 0.5).result()
    session.end_test()
    session.finish()
    told = [line.text for line in stage.writer.lines if isinstance(line, Remark)]
    assert session.recorder.trace == []
    several = "handed on in several places and called in a thread or by an operation in 1 test"
    assert told == [f"it is replaced by a mock in 1 test; {several}: such calls are not mutated"]
