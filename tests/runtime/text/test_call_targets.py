"""What stands at a call in the text, and what a mutant makes of a call of what stands in for the robot."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any
from unittest.mock import AsyncMock, MagicMock, Mock, call, create_autospec, patch

import pytest

from mutabot.model import Mutant, Role, Site
from mutabot.model.events import Remark
from mutabot.runtime.interception.dispatcher import is_coroutine_function
from tests.runtime.stage import Make, Stage, take_away

ROBOT = """
    import sys

    class Arm:
        def __init__(self):
            self.x, self.callers = 0.0, []

        def move_by(self, dx, speed=1.0):
            self.callers.append((sys._getframe(1).f_code.co_name, sys._getframe(1).f_lineno))
            self.x += dx

        @classmethod
        def home(cls, x):
            return x

    def tool(on, *, slowly=False):
        return on
"""
PROGRAM = """
    import robot
    from robot import Arm, tool

    class Own(Arm):
        def move_by(self, dx, speed=1.0):
            super().move_by(dx * 2)

    def run(arm):
        return arm.move_by(0.5, speed=2.0)

    def by_keyword(arm):
        return arm.move_by(dx=0.5)

    def through_the_class(arm):
        return Arm.move_by(arm, 0.5)

    def make():
        return Arm().move_by(0.5)

    def switch():
        return tool(True, slowly=True)

    def switch_module():
        return robot.tool(True)

    def own():
        return Own().move_by(0.5)

    def under_the_name_of_another(arm):
        tool = arm.move_by
        return tool(0.5)
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


def _sites(stage: Stage, function: str, *args: Any) -> list[tuple[str, Any]]:
    """The operations that a function of the program calls, with what they write."""
    session = stage.session()
    stage.load_program()
    session.start_test("test")
    stage.run(session, function, *args)
    sites = session.recorder.sites
    found = [
        (sites[index].operation.partition(":")[2], written) for index, written, *_ in session.recorder.trace
    ]
    take_away(session)
    del sys.modules[stage.program_name]
    return found


class Stranger:
    """Has nothing to do with the robot."""

    def move_by(self, *given: Any, **named: Any) -> None:
        """Stay."""


def _in_place(stage: Stage) -> dict[str, Any]:
    arm = stage.load_robot().Arm

    class Fake(arm):  # type: ignore[misc, valid-type]
        def move_by(self, distance: float, speed: float = 1.0) -> None:
            """The arguments have other names here."""

    instance = arm()
    instance.move_by = lambda *given, **named: None
    return {
        "the robot": arm(),
        "a fake of its class": Fake(),
        "an attribute of the object": instance,
        "a mock": Mock(),
        "a mock of it": MagicMock(spec=arm),
        "a mock around it": Mock(wraps=arm()),
        "an autospec": create_autospec(arm, instance=True),
        "a stub": Mock(move_by=Mock(side_effect=[None])),
    }


@pytest.mark.parametrize(
    "what",
    [
        "the robot", "a fake of its class", "an attribute of the object", "a mock", "a mock of it",
        "a mock around it", "an autospec", "a stub",
    ],
)  # fmt: skip
def test_a_call_of_what_stands_in_for_the_robot_is_seen_once(stage: Stage, what: str) -> None:
    session = stage.session()
    stage.load_program()
    arm = _in_place(stage)[what]
    session.start_test("test")
    stage.run(session, "run", arm)
    assert [(written, read) for _, written, read, _ in session.recorder.trace] == [({"dx": 0.5}, {})]


def test_what_has_no_tie_to_the_robot_is_left_alone(stage: Stage) -> None:
    assert _sites(stage, "run", Stranger()) == []


def test_what_the_program_defines_is_program(stage: Stage) -> None:
    session = stage.session()
    stage.load_program()
    session.start_test("test")
    stage.run(session, "own")
    ((index, written, *_),) = session.recorder.trace
    assert session.recorder.sites[index].span.function == "Own.move_by"
    assert written == {"dx": 1.0}


def test_patched_names_mean_the_operation_where_they_did_before(stage: Stage) -> None:
    session = stage.session()
    program = stage.load_program().__name__
    session.start_test("test")
    told: list[Any] = []

    def fake(on: bool, slowly: bool = False) -> None:
        told.append(on)

    with patch(f"{program}.tool", fake), patch(f"{program}.Arm", Stranger):
        stage.run(session, "switch")
        stage.run(session, "make")
    with patch(f"{stage.robot_name}.tool", autospec=True) as tool:
        stage.run(session, "switch_module")
    tool.assert_called_once_with(True)
    assert told == [True]
    assert [written for _, written, *_ in session.recorder.trace] == [{"on": True}, {"dx": 0.5}, {"on": True}]


def test_a_mutant_changes_what_a_mock_is_given_and_leaves_the_rest_as_written(stage: Stage) -> None:
    session, arm = stage.session(), Mock()
    stage.run(session, "run", arm)
    take_away(session)
    (seen,) = stage.sites()
    site = Site(seen.span, "arm.move_by", 1, Role.PROGRAM)
    mutant = Mutant(1, "robot", "reverse", site, seen.operation, None, "dx", "", "", None)
    del sys.modules[stage.program_name]
    stage.run(stage.session(mutant), "run", arm)
    assert arm.mock_calls == [call.move_by(0.5, speed=2.0), call.move_by(-0.5, speed=2.0)]


def test_a_robot_that_looks_at_its_caller_finds_the_program(stage: Stage) -> None:
    session = stage.session()
    stage.load_program()
    arm = stage.load_robot().Arm()
    session.start_test("test")
    for function in ("run", "by_keyword", "through_the_class"):
        stage.run(session, function, arm)
    lines = [stage.load_program().__dict__[name].__code__.co_firstlineno + 1 for name in
             ("run", "by_keyword", "through_the_class")]  # fmt: skip
    assert arm.callers == list(zip(("run", "by_keyword", "through_the_class"), lines, strict=True))


def test_check_says_what_stood_in_and_what_was_left_alone(stage: Stage) -> None:
    session = stage.session(inspect=True)
    stage.load_program()
    for number, arm in enumerate((Mock(), Mock(), Stranger())):
        session.start_test(f"test {number}")
        stage.run(session, "run" if number < 2 else "by_keyword", arm)
        session.end_test()
    session.finish()
    told = {line.key: line.text for line in stage.writer.lines if isinstance(line, Remark)}
    assert told["call"] == "it is replaced by a mock in 2 tests"
    assert told["method"].startswith("1 call of move_by on other objects may be another function: ")
    assert told["method"].endswith('they get no mutants; if they are this one, write method = "move_by"')


def test_check_names_what_a_test_puts_into_an_object_in_the_place_of_its_operation(stage: Stage) -> None:
    session = stage.session(inspect=True)
    stage.load_program()
    arm = stage.load_robot().Arm()
    arm.move_by = lambda *given, **named: None
    session.start_test("test")
    stage.run(session, "run", arm)
    session.end_test()
    session.finish()
    (told,) = (line.text for line in stage.writer.lines if isinstance(line, Remark))
    own = test_check_names_what_a_test_puts_into_an_object_in_the_place_of_its_operation.__qualname__
    assert told == f"it is replaced by {__name__}:{own}.<locals>.<lambda> in 1 test"


def test_check_calls_no_operation_left_alone_that_is_kept_under_the_name_of_another(stage: Stage) -> None:
    session = stage.session(inspect=True)
    stage.load_program()
    session.start_test("test")
    stage.run(session, "under_the_name_of_another", stage.load_robot().Arm())
    session.end_test()
    session.finish()
    assert [written for _, written, *_ in session.recorder.trace] == [{"dx": 0.5}]
    assert not [line for line in stage.writer.lines if isinstance(line, Remark) and line.key == "method"]


def test_a_method_counts_for_whatever_object_has_it(make_stage: Make) -> None:
    vocabulary = """
        [[operation]]
        method = "move_by"
        signature = "(dx, speed=1.0)"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    """
    stage = make_stage(ROBOT, PROGRAM, vocabulary)
    for arm in (Stranger(), Mock()):
        assert _sites(stage, "by_keyword", arm) == [("*.move_by", {"dx": 0.5})]


@pytest.mark.parametrize(
    "go",
    [
        "Arm().move_by(0.5)",
        "Arm.move_by(Arm(), 0.5)",
        "list(map(Arm().move_by, [0.5]))",
        "type('Fast', (Arm,), {})().move_by(0.5)",
    ],
)
def test_a_class_of_a_module_that_the_tests_put_in_place_has_the_operation(
    make_stage: Make, monkeypatch: pytest.MonkeyPatch, go: str
) -> None:
    vocabulary = """
        [[operation]]
        call = "sdk_of_the_maker:Arm.move_by"
        signature = "(dx)"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    """
    stage = make_stage(ROBOT, f"def run():\n    from sdk_of_the_maker import Arm\n    {go}\n", vocabulary)
    session = stage.session()
    stage.load_program()
    for number in range(2):  # each test has a module of its own, which nothing imports
        moved: list[float] = []
        arm = type("Arm", (), {"move_by": lambda self, dx, moved=moved: moved.append(dx)})
        module = ModuleType("sdk_of_the_maker")
        vars(module)["Arm"] = arm
        monkeypatch.setitem(sys.modules, module.__name__, module)
        session.start_test(f"test {number}")
        stage.run(session, "run")
        assert moved == [0.5]
        assert [written for _, written, *_ in session.recorder.trace] == [{"dx": 0.5}]


async def _awaited(arm: Any) -> Any:
    return await arm.move_by(0.5)


def test_mocks_that_are_awaited_are_known_as_such() -> None:
    assert is_coroutine_function(AsyncMock())
    assert is_coroutine_function(_awaited)
    assert not is_coroutine_function(Mock())
    assert not is_coroutine_function(sys.getsizeof)
