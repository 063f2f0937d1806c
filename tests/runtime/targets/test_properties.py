"""Properties as operations: their reading, or with arguments their assignments."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from textwrap import dedent
from types import ModuleType
from unittest.mock import PropertyMock, patch

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot.runtime.targets.callables import look_at
from mutabot.runtime.targets.target import NotFoundError, resolve
from tests.runtime.stage import Make

BY = '{ kind = "translation", axis = "x", unit = "m", mode = "by" }'


class _Arm:
    speed = property(lambda self: 1.0, lambda self, value: None)
    height = property(lambda self: 1.0)
    reach = cached_property(lambda self: 1.0)


def _findings(folder: Path, name: str, line: str) -> list[tuple[str, str]]:
    (folder / "robot.toml").write_text(
        f'[[operation]]\ncall = "robot:Arm.{name}"\n{line}\n', encoding="utf-8"
    )
    (operation,) = load_vocabulary(["robot.toml"], folder).operations
    return [(problem.key, problem.text) for problem in look_at(operation, vars(_Arm)[name])]


@pytest.mark.parametrize("name", ["speed", "height", "reach"])
def test_a_property_may_be_read(tmp_path: Path, name: str) -> None:
    assert _findings(tmp_path, name, 'result = { kind = "position", axis = "x", unit = "m" }') == []


@pytest.mark.parametrize("name", ["height", "reach"])
def test_arguments_of_a_property_that_cannot_be_set_are_refused(tmp_path: Path, name: str) -> None:
    ((key, text),) = _findings(tmp_path, name, f"arguments.value = {BY}")
    assert (key, text) == (
        "arguments.value",
        f"robot:Arm.{name} is a property that cannot be set; describe its result",
    )


@pytest.mark.parametrize("part", ["fset", "setter", "fget.__call__"])
def test_a_part_of_a_property_is_refused_with_what_to_name_instead(part: str) -> None:
    module = ModuleType("robot")
    vars(module)["Arm"] = _Arm
    with pytest.raises(
        NotFoundError, match=rf"^robot:Arm\.speed\.{part} is a part .* name the property itself$"
    ):
        resolve(module, f"Arm.speed.{part}")


def test_the_arguments_are_those_of_the_setter(tmp_path: Path) -> None:
    assert _findings(tmp_path, "speed", f"arguments.value = {BY}") == []
    assert _findings(tmp_path, "speed", f"arguments.other = {BY}") == [
        ("arguments.other", "robot:Arm.speed has no argument 'other'")
    ]


def test_an_assignment_returns_nothing_to_describe(tmp_path: Path) -> None:
    lines = f'arguments.value = {BY}\nresult = {{ kind = "position", axis = "x", unit = "m" }}'
    ((key, text),) = _findings(tmp_path, "speed", lines)
    assert key == "result"
    assert text == (
        "robot:Arm.speed is a property: its arguments are those of assignments, which return nothing; "
        "describe one of the two"
    )


ROBOT = """
    LOG = []

    class Arm:
        x = 1.0

        @property
        def goal(self):
            return self.x

        @goal.setter
        def goal(self, value):
            LOG.append(value)
            self.x = value
"""
SET = f"""
    [[operation]]
    call = "robot:Arm.goal"
    arguments.value = {BY}
"""


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("arm.goal = 2.0", [-2.0]),
        ("arm.goal += 1.0", [-2.0]),
        ("setattr(arm, 'goal', 2.0)", [-2.0]),
        ("one, arm.goal = 1.0, 2.0", [-2.0]),
    ],
)
def test_an_assignment_is_a_site(make_stage: Make, line: str, expected: list[float]) -> None:
    head = "import robot\n\ndef run():\n    robot.LOG.clear()\n    arm = robot.Arm()\n"
    program = f"{head}    {line}\n    return robot.LOG\n"
    stage = make_stage(ROBOT, program, dedent(SET))
    log, mutant = stage.mutated("reverse", "value")
    assert list(log) == expected
    assert mutant.activity.acted == 1
    assert {seen.span.line for seen in stage.sites()} == {6}


def test_a_reading_of_a_property_whose_assignments_are_described_is_none(make_stage: Make) -> None:
    stage = make_stage(ROBOT, "import robot\n\ndef run():\n    return robot.Arm().goal\n", dedent(SET))
    stage.run(stage.session())
    assert stage.sites() == []


def test_an_assignment_to_a_patched_property_is_a_site(make_stage: Make) -> None:
    program = "import robot\n\ndef run():\n    arm = robot.Arm()\n    arm.goal = 2.0\n    return arm.goal\n"
    stage = make_stage(ROBOT, program, dedent(SET))
    session = stage.session()
    stage.load_program()
    with patch.object(stage.load_robot().Arm, "goal", new_callable=PropertyMock) as goal:
        stage.run(session)
    assert [call.args for call in goal.mock_calls] == [(2.0,), ()]
    assert [written for _, written, *_ in session.recorder.trace] == [{"value": 2.0}]
