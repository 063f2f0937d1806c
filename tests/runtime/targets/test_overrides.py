"""Methods that override an operation's."""

from __future__ import annotations

import pytest

from tests.runtime.stage import Make

ROBOT = """
    import abc
    import functools

    LOG = []

    class Arm(abc.ABC):
        @abc.abstractmethod
        def move(self, x): ...

        @property
        def height(self): return 0.0

    class Real(Arm):
        def move(self, x):
            LOG.append(x)
            return x

        @property
        def height(self): return 0.5

    class Wrapper(Arm):
        \"\"\"Stands around another arm, as a Gymnasium wrapper does.\"\"\"
        def __init__(self, inner): self.inner = inner
        def move(self, distance): return self.inner.move(distance)

    class Outer(Wrapper):
        def move(self, distance): return super().move(distance)

    class Plain:
        def __init_subclass__(cls, /, tag=None, **options):
            super().__init_subclass__(**options)
            cls.tag = tag
        def move(self, x): return x
        async def amove(self, x): return x

    class Polite(Plain, tag="polite"):
        def move(self, x):
            return super().move(x)

    class Rude(Plain):
        def __init_subclass__(cls): pass
        def move(self, x):
            return 10 + x
        async def amove(self, x):
            return 10 + x

    class Leaf(Rude):
        def move(self, x):
            return 20 + x

    class Odd(Plain):
        move = 3
"""


def vocabulary(target: str, *lines: str, argument: str = "x") -> str:
    meaning = '{ kind = "translation", axis = "x", unit = "m", mode = "by" }'
    return "\n".join(
        [f'[[operation]]\ncall = "robot:{target}"', f"arguments.{argument} = {meaning}", *lines, ""]
    )


COVERED = vocabulary("Arm.move", "overrides = true")


def program(*lines: str) -> str:
    body = "\n".join(f"    {line}" for line in lines)
    return f"import asyncio\nimport robot\n\ndef run():\n    robot.LOG.clear()\n{body}\n"


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (["return robot.Real().move(1.0)"], -1.0),
        (["return robot.Real().move(x=1.0)"], -1.0),
        (["class Mine(robot.Real):", "    def move(self, x): return 5 + x", "return Mine().move(1.0)"], 4.0),
        (
            ["Mine = type('Mine', (robot.Real,), {'move': lambda self, x: x})", "return Mine().move(1.0)"],
            -1.0,
        ),
    ],
)
def test_with_overrides_a_mutant_reaches_the_methods_of_subclasses(
    make_stage: Make, lines: list[str], expected: float
) -> None:
    stage = make_stage(ROBOT, program(*lines), COVERED)
    result, activation = stage.mutated("reverse", "x")
    assert result == expected
    assert (activation.activity.hits, activation.activity.acted) == (1, 1)
    assert {seen.operation for seen in stage.sites()} == {f"{stage.robot_name}:Arm.move"}


def test_only_the_outermost_of_overriding_methods_counts(make_stage: Make) -> None:
    lines = ["arm = robot.Outer(robot.Wrapper(robot.Real()))", "return arm.move(1.0), list(robot.LOG)"]
    stage = make_stage(ROBOT, program(*lines), COVERED)
    session = stage.session()
    assert stage.run(session) == (1.0, [1.0])
    assert session.meter is not None
    assert session.meter.operations == 1


def test_an_overriding_method_is_read_by_its_own_signature(make_stage: Make) -> None:
    robot = """
        class Arm:
            def move(self, x, y=0.0): return x, y

        class Other(Arm):
            def move(self, y, x=0.5): return x, y
    """
    lines = ["robot.LOG = []", "return robot.Arm().move(1.0), robot.Other().move(3.0, 2.0)"]
    stage = make_stage(robot + "\n        LOG = []\n", program(*lines), COVERED)
    result, _ = stage.mutated("reverse", "x", index=1)
    assert result == ((1.0, 0.0), (-2.0, 3.0))


def test_a_coroutine_method_of_a_subclass_is_reached(make_stage: Make) -> None:
    text = vocabulary("Plain.amove", "overrides = true")
    stage = make_stage(ROBOT, program("return asyncio.run(robot.Rude().amove(1.0))"), text)
    assert stage.mutated("reverse", "x")[0] == 9.0


def test_the_nearest_operation_is_that_of_an_overriding_method(make_stage: Make) -> None:
    text = vocabulary("Plain.move", "overrides = true") + vocabulary("Rude.move", "overrides = true")
    lines = ["return robot.Leaf().move(1.0), robot.Rude().move(1.0), robot.Polite().move(1.0)"]
    stage = make_stage(ROBOT, program(*lines), text)
    assert stage.run(stage.session()) == (21.0, 11.0, 1.0)
    operations = [seen.operation.partition(":")[2] for seen in stage.sites()]
    assert operations == ["Rude.move", "Rude.move", "Plain.move"]


def test_without_overrides_what_the_program_defines_is_program(make_stage: Make) -> None:
    lines = ["class Mine(robot.Real):", "    def move(self, x): return 5 + x", "return Mine().move(1.0)"]
    stage = make_stage(ROBOT, program(*lines), vocabulary("Arm.move"))
    assert stage.run(stage.session()) == 6.0
    assert stage.sites() == []
