"""Which callables can be intercepted, however the program got hold of them."""

from __future__ import annotations

import asyncio
import inspect
from textwrap import dedent

import pytest

from mutabot.model.events import Problem
from tests.runtime.stage import Make

ROBOT = """
    import functools

    LOG = []

    def move(x=0.0):
        LOG.append(("move", x))

    async def amove(x=0.0):
        LOG.append(("amove", x))
        return x

    class Base:
        def inherited(self, x):
            LOG.append(("inherited", x))

    class Arm(Base):
        def method(self, x):
            LOG.append(("method", x))

        @classmethod
        def on_class(cls, x):
            LOG.append(("on_class", cls.__name__, x))

        @staticmethod
        def static(x):
            LOG.append(("static", x))

        async def amethod(self, x):
            LOG.append(("amethod", x))

        slowly = functools.partialmethod(method)

        @functools.singledispatchmethod
        def by_type(self, x):
            raise TypeError(x)

        @by_type.register
        def _(self, x: float):
            LOG.append(("by_type", x))

        @property
        def height(self):
            LOG.append(("height",))
            return 0.5

        @functools.cached_property
        def reach(self):
            return 0.9
"""
X = 'arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "by" }'


def operation(target: str, *lines: str) -> str:
    return dedent("\n".join(["[[operation]]", f'call = "robot:{target}"', *(lines or (X,))]))


@pytest.mark.parametrize(
    ("target", "call"),
    [
        ("move", "robot.move(0.25)"),
        ("move", "robot.move(x=0.25)"),
        ("Arm.method", "robot.Arm().method(0.25)"),
        ("Arm.method", "robot.Arm().method(x=0.25)"),
        ("Arm.inherited", "robot.Arm().inherited(0.25)"),
        ("Arm.on_class", "robot.Arm.on_class(0.25)"),
        ("Arm.on_class", "robot.Arm().on_class(0.25)"),
        ("Arm.static", "robot.Arm.static(0.25)"),
        ("amove", "asyncio.run(robot.amove(0.25))"),
        ("Arm.amethod", "asyncio.run(robot.Arm().amethod(0.25))"),
        ("Arm.slowly", "robot.Arm().slowly(0.25)"),
        ("Arm.by_type", "robot.Arm().by_type(0.25)"),
    ],
)
def test_a_mutant_reaches_this_kind_of_callable(make_stage: Make, target: str, call: str) -> None:
    program = f"import asyncio\nimport robot\n\ndef run():\n    {call}\n    return robot.LOG[-1][-1]\n"
    stage = make_stage(ROBOT, program, operation(target, 'signature = "(x)"', X))
    result, activation = stage.mutated("reverse", "x")
    assert result == -0.25
    assert (activation.activity.hits, activation.activity.acted) == (1, 1)


@pytest.mark.parametrize(("name", "value"), [("height", 0.5), ("reach", 0.9)])
def test_a_mutant_reaches_a_property(make_stage: Make, name: str, value: float) -> None:
    program = f"import robot\n\ndef run():\n    return robot.Arm().{name}\n"
    result = 'result = { kind = "position", axis = "z", unit = "m" }'
    stage = make_stage(ROBOT, program, operation(f"Arm.{name}", result))
    assert stage.mutated("negate", "result")[0] == -value


@pytest.mark.parametrize(
    ("program", "early"),
    [
        ("from robot import move\n\ndef run():\n    move(0.25)\n", True),
        ("from robot import move\n\ndef run():\n    move(0.25)\n", False),
        ("from robot import move as go\n\ndef run():\n    go(0.25)\n", True),
        ("from robot import move as go\n\ndef run():\n    go(0.25)\n", False),
        ("import robot\n\nclass Task:\n    go = robot.move\n\ndef run():\n    Task.go(0.25)\n", True),
        ("import robot\n\ndef run(go=robot.move):\n    go(0.25)\n", True),
    ],
)
def test_names_taken_from_a_module_are_intercepted(make_stage: Make, program: str, early: bool) -> None:
    stage = make_stage(ROBOT, program, operation("move"))
    if not early:
        stage.load_program()
    stage.run(stage.session())
    assert [seen.operation for seen in stage.sites()] == [f"{stage.robot_name}:move"]


def test_an_intercepted_callable_keeps_its_face(make_stage: Make) -> None:
    stage = make_stage(ROBOT, "import robot\n", operation("move") + "\n" + operation("amove"))
    robot = stage.load_robot()
    stage.session()
    assert robot.move.__name__ == "move"
    assert str(inspect.signature(robot.move)) == "(x=0.0)"
    assert inspect.iscoroutinefunction(robot.amove)


@pytest.mark.parametrize(
    ("target", "name", "known"),
    [("moove", "moove", "move"), ("Arm.metod", "metod", "method"), ("Amr.method", "Amr", "Arm")],
)
def test_a_target_that_does_not_exist_is_reported_with_what_there_is(
    make_stage: Make, target: str, name: str, known: str
) -> None:
    stage = make_stage(ROBOT, "import robot\n\ndef run():\n    robot.move(1.0)\n", operation(target))
    session = stage.session()
    stage.run(session)
    problem = next(line for line in stage.writer.lines if isinstance(line, Problem))
    assert problem.name == name
    assert known in problem.known
    assert "robot.toml" in problem.source


def test_a_class_is_not_an_operation(make_stage: Make) -> None:
    stage = make_stage(ROBOT, "import robot\n\ndef run():\n    robot.Arm()\n", operation("Arm"))
    stage.run(stage.session())
    assert any(isinstance(line, Problem) and "is a class" in line.text for line in stage.writer.lines)


def test_an_argument_that_does_not_exist_is_reported(make_stage: Make) -> None:
    wrong = operation("move", 'arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }')
    stage = make_stage(ROBOT, "import robot\n\ndef run():\n    robot.move(1.0)\n", wrong)
    session = stage.session()
    stage.run(session)
    session.inspect_targets()
    problem = next(line for line in stage.writer.lines if isinstance(line, Problem))
    assert (problem.name, problem.known) == ("dx", ("x",))


def test_a_module_that_cannot_be_imported_is_reported(make_stage: Make) -> None:
    stage = make_stage(ROBOT, "X = 1\n", operation("move").replace("robot:", "no_such_robot:"))
    session = stage.session()
    session.inspect_targets()
    assert any(isinstance(line, Problem) and "no_such_robot" in line.text for line in stage.writer.lines)


def test_two_tasks_at_once_do_not_hide_each_others_operations(make_stage: Make) -> None:
    program = """
        import asyncio
        import robot

        async def both():
            await asyncio.gather(robot.amove(1.0), robot.amove(2.0))

        def run():
            asyncio.run(both())
    """
    stage = make_stage(ROBOT, program, operation("amove"))
    session = stage.session()
    stage.run(session)
    assert len(session.recorder.trace) == 2


def test_an_async_operation_that_is_cancelled_leaves_no_trace_of_being_under_way(make_stage: Make) -> None:
    program = """
        import asyncio
        import robot

        async def run_async():
            task = asyncio.ensure_future(robot.amove(1.0))
            await asyncio.sleep(0)
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            await robot.amove(2.0)
    """
    stage = make_stage(ROBOT, program, operation("amove"))
    session = stage.session()
    asyncio.run(stage.load_program().run_async())
    assert len(session.recorder.trace) == 2
