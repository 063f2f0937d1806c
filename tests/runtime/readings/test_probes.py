"""Probes: what they are read from, and what is said where they cannot be read."""

from __future__ import annotations

import gc
import importlib
import sys
import weakref
from typing import Any

import pytest

from mutabot.campaign.comparison import Observation, compare
from mutabot.model.events import Problem
from mutabot.runtime.observation.probes import Reading
from tests.runtime.stage import Make, Stage

ROBOT = """
    from dataclasses import dataclass

    class Arm:
        KINDS = ["six axes"]

        def __init__(self, x=0.0):
            self.x = x

        def move_by(self, dx):
            self.x += dx

        def where(self):
            return [self.x, "m"]

        def away(self, place):
            return self.x - place

        @property
        def twice(self):
            return 2 * self.x

        @classmethod
        def kinds(cls):
            return cls.KINDS

        @staticmethod
        def gravity():
            return 9.81

        async def later(self):
            return self.x

        def itself(self):
            return self

    class Longer(Arm):
        def __init__(self):
            pass

        x = 3.0

    class Bare:
        def at(self):
            return 1

    class Mixed(Bare, Arm):
        pass

    ARM = Arm(7.0)
    STATE = {"box": (1, 2)}

    def nothing():
        return None
"""
PROGRAM = """
    import robot

    def run(*starts):
        arms = [robot.Arm(start) for start in starts]
        for arm in reversed(arms):
            arm.move_by(0.5)
        return arms
"""
OPERATION = """
[[operation]]
call = "robot:Arm.move_by"
arguments.dx = { kind = "translation", mode = "by", unit = "m" }
"""


def stage_with(make_stage: Make, *probes: str, operation: str = OPERATION) -> Stage:
    return make_stage(
        ROBOT, PROGRAM, operation + "".join(f'[[probe]]\ncall = "{probe}"\n' for probe in probes)
    )


def read(stage: Stage, *starts: float) -> Reading:
    """The probes at the end of a test that runs the program; names without the module."""
    session = stage.session()
    kept = stage.run(session, "run", *starts)
    reading = session.take_probes()
    del kept
    names = f"{stage.robot_name}:"
    return Reading(
        *(
            {key.replace(names, ""): value for key, value in part.items()}
            for part in (reading.values, reading.unread)
        )
    )


@pytest.mark.parametrize(
    ("probe", "values"),
    [
        ("robot:Arm.where", {"Arm.where[0]": 0.75, "Arm.where[1]": "m"}),
        ("robot:Arm.x", {"Arm.x": 0.75}),
        ("robot:Arm.twice", {"Arm.twice": 1.5}),
        ("robot:Arm.kinds", {"Arm.kinds[0]": "six axes"}),
        ("robot:Arm.KINDS", {"Arm.KINDS[0]": "six axes"}),
        ("robot:Arm.gravity", {"Arm.gravity": 9.81}),
        ("robot:ARM.where", {"ARM.where[0]": 7.0, "ARM.where[1]": "m"}),
        ("robot:STATE", {"STATE.box[0]": 1, "STATE.box[1]": 2}),
        ("robot:nothing", {}),
    ],
)
def test_a_probe_is_a_function_method_property_or_attribute(
    make_stage: Make, probe: str, values: dict[str, Any]
) -> None:
    assert read(stage_with(make_stage, probe), 0.25) == Reading(values, {})


def test_a_method_is_read_from_each_object_that_the_program_used_in_this_order(make_stage: Make) -> None:
    found = read(stage_with(make_stage, "robot:Arm.x"), 1.0, 2.0)
    assert found.values == {"Arm.x": 2.5, "Arm.x#2": 1.5}


def test_objects_that_no_operation_is_called_on_are_read_from_the_last_one_made(make_stage: Make) -> None:
    operation = OPERATION.replace("Arm.move_by", "Bare.at").replace("arguments.dx", "command = true #")
    found = read(stage_with(make_stage, "robot:Arm.x", operation=operation), 1.0, 2.0)
    assert found.values == {"Arm.x": 2.5}


def test_an_object_made_before_the_test_is_read_where_the_test_makes_none(make_stage: Make) -> None:
    assert read(stage_with(make_stage, "robot:Arm.x")).values == {"Arm.x": 7.0}


def test_what_the_program_lets_go_is_kept_until_the_probes_are_read_and_no_longer(make_stage: Make) -> None:
    stage = stage_with(make_stage, "robot:Arm.x")
    session = stage.session()
    gone = weakref.ref(stage.run(session, "run", 1.0)[0])
    assert session.take_probes().values == {f"{stage.robot_name}:Arm.x": 1.5}
    gc.collect()
    assert gone() is None


@pytest.mark.parametrize(
    ("probe", "words"),
    [
        ("robot:Arm.away", "it needs place; a probe is called without arguments"),
        ("robot:Arm.wher", "Arm has no 'wher'; did you mean 'where'?"),
        ("robot:Arm.later", "it is a coroutine function"),
        ("robot:Arm.itself", "not plain data"),
        ("robot:Bare.at", "no object of Bare is known"),
        ("not_imported:world", "no test has imported its module 'not_imported'"),
    ],
)
def test_what_cannot_be_read_says_why(make_stage: Make, probe: str, words: str) -> None:
    found = read(stage_with(make_stage, probe), 0.0)
    assert found.values == {}
    assert words in found.unread[probe.removeprefix("robot:")]


def test_an_error_of_one_probe_leaves_the_others(make_stage: Make) -> None:
    found = read(stage_with(make_stage, "robot:Arm.away", "robot:Arm.x"), 0.0)
    assert found.values == {"Arm.x": 0.5}
    assert list(found.unread) == ["Arm.away"]


def test_watching_a_class_changes_nothing_about_making_its_objects(make_stage: Make) -> None:
    stage = stage_with(make_stage, "robot:Arm.x", "robot:Bare.at", "robot:Longer.x")
    stage.session()
    robot = stage.load_robot()
    assert robot.Arm(2.0).x == 2.0
    assert robot.Mixed(4.0).x == 4.0  # Bare has no __init__: Arm's comes next
    assert robot.Longer().x == 3.0
    with pytest.raises(TypeError, match="no arguments"):
        robot.Bare(1)
    with pytest.raises(TypeError, match="takes from 1 to 2"):
        robot.Arm(1, 2)


def test_a_current_of_the_same_object_can_be_asked(make_stage: Make) -> None:
    robot = "class Arm:\n    def move_by(self, dx): ...\n    def pose(self): return 1.0\n"
    reading = (
        '[[operation]]\ncall = "robot:Arm.pose"\nresult = { kind = "position", axis = "x", unit = "m" }\n'
    )
    moving = OPERATION.replace('unit = "m"', 'axis = "x", unit = "m"')
    stage = make_stage(
        robot,
        "import robot\n\ndef run():\n    robot.Arm().move_by(1)\n",
        f'{moving}current = "robot:Arm.pose"\n{reading}',
    )
    inspect(stage)
    assert not [line for line in stage.writer.lines if isinstance(line, Problem)]


def test_a_result_path_is_refused_only_if_no_result_has_it(make_stage: Make) -> None:
    robot = "def locate(seen): return [0.5] if seen else []\n"
    vocabulary = '[[operation]]\ncall = "robot:locate"\nresult."[{}]" = {{ kind = "position", unit = "m" }}\n'
    program = "import robot\n\ndef run():\n    robot.locate(False)\n    robot.locate(True)\n"
    good, bad = (make_stage(robot, program, vocabulary.format(index)) for index in (0, 1))
    inspect(good)
    assert not [line for line in good.writer.lines if isinstance(line, Problem)]
    assert problem_of(bad).key == "result.[1]"


def inspect(stage: Stage) -> None:
    session = stage.session(inspect=True)
    stage.run(session)
    session.finish()


def problem_of(stage: Stage) -> Problem:
    inspect(stage)
    return next(line for line in stage.writer.lines if isinstance(line, Problem))


CALLED = {
    "operation": OPERATION.replace("Arm.move_by", "Bare.at").replace("arguments.dx", "command = true #")
}


def test_an_object_of_another_test_is_never_read(make_stage: Make) -> None:
    """It lives on, as what lies in a garbage cycle or in a global of the tests does."""
    stage = stage_with(make_stage, "robot:Arm.x", **CALLED)
    session = stage.session()
    session.start_test("first", tuple)
    kept = stage.run(session, "run", 1.0)
    assert session.take_probes().values == {f"{stage.robot_name}:Arm.x": 1.5}
    session.start_test("second", tuple)
    assert session.take_probes().values == {f"{stage.robot_name}:Arm.x": 7.0}  # made with the module
    session.start_test("third", lambda: kept)  # a fixture of wider scope, which this test uses
    assert session.take_probes().values == {f"{stage.robot_name}:Arm.x": 1.5}


def test_without_an_object_of_its_own_a_test_cannot_read_a_probe(make_stage: Make) -> None:
    stage = stage_with(make_stage, "robot:Bare.at")
    session = stage.session()
    session.start_test("first", tuple)
    kept = stage.load_robot().Bare()
    assert session.take_probes().values == {f"{stage.robot_name}:Bare.at": 1}
    session.start_test("second", tuple)
    assert "no object of Bare is known" in session.take_probes().unread[f"{stage.robot_name}:Bare.at"]
    del kept


def test_what_a_module_makes_while_a_test_imports_it_is_there_for_all_tests(make_stage: Make) -> None:
    stage = stage_with(make_stage, "robot:Arm.x", **CALLED)
    session = stage.session()
    (stage.folder / "made_late.py").write_text(f"import {stage.robot_name} as robot\nARM = robot.Arm(2.0)\n")
    session.start_test("first", tuple)
    importlib.import_module("made_late")
    session.start_test("second", tuple)
    assert session.take_probes().values == {f"{stage.robot_name}:Arm.x": 2.0}
    del sys.modules["made_late"]


@pytest.mark.parametrize(
    ("state", "parts"),
    [
        ("{}", {"STATE": {}}),
        ("[]", {"STATE": []}),
        ("()", {"STATE": []}),
        ("{'boxes': [], 'held': {}}", {"STATE.boxes": [], "STATE.held": {}}),
        ("0", {"STATE": 0}),
    ],
)
def test_what_is_empty_is_a_value(make_stage: Make, state: str, parts: dict[str, Any]) -> None:
    robot = ROBOT.replace('{"box": (1, 2)}', state)
    stage = make_stage(robot, PROGRAM, OPERATION + '[[probe]]\ncall = "robot:STATE"\n')
    assert read(stage, 0.25) == Reading(parts, {})


def test_a_list_that_is_empty_at_the_end_differs_from_one_that_is_not() -> None:
    full, empty = Observation(probes={"robot:boxes[0]": 1}), Observation(probes={"robot:boxes": []})
    assert compare(full, empty).divergence == (
        "boxes[0]: nothing instead of 1",
        "boxes: [] instead of nothing",
    )
    assert compare(empty, empty).indistinguishable
