"""Calls that are made later, answers that do not come, and what a call knows of the one before it."""

from __future__ import annotations

from textwrap import dedent, indent
from typing import Any

import pytest

from mutabot.runtime.interception.active_mutant import MutatedSite
from tests.runtime.stage import Make

pytestmark = pytest.mark.needs("catalogue")

ROBOT = """
    import asyncio

    LOG = []

    class Refused(Exception):
        pass

    class NoImage(Exception):
        def __init__(self, camera, why):
            super().__init__(f"{camera}: {why}")

    class Pose:
        def __init__(self, x):
            self.x = x

    def move(x):
        if x > 5:
            raise Refused(x)
        LOG.append(f"move {x:g}")

    def go(pose):
        LOG.append(f"go {pose.x:g}")

    async def amove(x):
        await asyncio.sleep(0)
        LOG.append(f"amove {x:g}")

    def grip(width):
        LOG.append(f"grip {width:g}")

    def see():
        return 0.5

    def do(function):
        function()
        LOG.append("done")
"""
VOCABULARY = """
    refusals = ["robot:Refused"]

    [[operation]]
    call = "robot:move"
    arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "to" }

    [[operation]]
    call = "robot:go"
    arguments."pose.x" = { kind = "translation", axis = "x", unit = "m", mode = "to" }

    [[operation]]
    call = "robot:amove"
    arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "to" }

    [[operation]]
    call = "robot:grip"
    arguments.width = { kind = "opening", unit = "mm", range = [0, 85] }

    [[operation]]
    call = "robot:do"

    [[operation]]
    call = "robot:see"
    result = { kind = "distance", unit = "m", missing = "robot:NoImage" }
"""


def done(make_stage: Make, lines: str, operator: str, quantity: str | None = None, **more: Any) -> Any:
    """What the robot did for the mutant, and the mutant."""
    text = (
        f"import asyncio\nimport robot\n\ndef run():\n    robot.LOG.clear()\n{indent(dedent(lines), ' ' * 4)}"
    )
    stage = make_stage(ROBOT, f"{text}\n    return list(robot.LOG)\n", VOCABULARY)
    found, activation = stage.mutated(operator, quantity, **more)
    assert isinstance(activation, MutatedSite)
    return found, activation.activity


def test_a_deferred_command_is_made_after_the_next_one_and_not_after_a_reading(make_stage: Make) -> None:
    log, activity = done(make_stage, "robot.move(1)\nrobot.see()\nrobot.move(2)\nrobot.move(3)", "swap-next")
    assert log == ["move 2", "move 1", "move 3"]
    assert (activity.hits, activity.acted) == (1, 1)


def test_a_command_in_a_callback_is_not_made_at_the_end_of_what_called_back(make_stage: Make) -> None:
    lines = "robot.do(lambda: robot.move(1))\nrobot.move(2)\nrobot.move(3)"
    log, activity = done(make_stage, lines, "swap-next")
    assert log == ["done", "move 2", "move 1", "move 3"]
    assert (activity.hits, activity.acted) == (1, 1)


def test_a_command_after_which_none_comes_is_never_made(make_stage: Make) -> None:
    log, activity = done(make_stage, "robot.move(1)", "swap-next")
    assert log == []
    assert activity.acted == 1


def test_in_a_loop_commands_change_places_two_by_two(make_stage: Make) -> None:
    log, activity = done(make_stage, "for x in range(5):\n    robot.move(x)", "swap-next")
    assert log == ["move 1", "move 0", "move 3", "move 2"]
    assert (activity.hits, activity.acted) == (5, 3)


def test_a_deferred_command_is_what_the_program_said_then(make_stage: Make) -> None:
    lines = "pose = robot.Pose(1)\nfor x in (1, 2):\n    pose.x = x\n    robot.go(pose)"
    log, _ = done(make_stage, lines, "swap-next")
    assert log == ["go 2", "go 1"]


def test_a_command_that_is_awaited_waits_for_one_that_is(make_stage: Make) -> None:
    lines = """
        async def all():
            await robot.amove(1)
            robot.move(2)
            await robot.amove(3)
        asyncio.run(all())
    """
    log, _ = done(make_stage, lines, "swap-next")
    assert log == ["move 2", "amove 3", "amove 1"]


def test_what_the_robot_refuses_later_is_a_refusal(make_stage: Make) -> None:
    lines = "try:\n    robot.move(1)\n    robot.grip(3)\nexcept robot.Refused:\n    robot.LOG.append('no')"
    log, activity = done(make_stage, lines, "swap-next")
    assert log == ["grip 3", "move 1"]
    lines = lines.replace("robot.move(1)", "robot.move(4 + len(robot.LOG))").replace("(4", "(9")
    stage_log, activity = done(
        make_stage, f"try:\n    robot.move(1)\nexcept robot.Refused:\n    pass\n{lines}", "swap-next", index=1
    )
    assert stage_log[-1] == "no"
    assert activity.refusal is not None


def test_a_gripper_goes_back_after_the_next_command_and_only_then_has_the_mutant_acted(
    make_stage: Make,
) -> None:
    log, activity = done(make_stage, "robot.grip(0)\nrobot.move(1)\nrobot.move(2)", "early-release")
    assert log == ["grip 0", "move 1", "grip 85", "move 2"]
    assert activity.acted == 1
    log, activity = done(make_stage, "robot.move(1)\nrobot.grip(0)", "early-release", index=1)
    assert log == ["move 1", "grip 0"]
    assert activity.acted == 0


def test_the_call_before_is_the_one_of_the_same_operation_wherever_it_stands(make_stage: Make) -> None:
    lines = "robot.move(1)\nrobot.grip(5)\nrobot.move(2)"
    assert done(make_stage, lines, "previous-target", index=2)[0] == ["move 1", "grip 5", "move 1"]
    log, activity = done(make_stage, lines, "previous-target")
    assert log == ["move 1", "grip 5", "move 2"]
    assert activity.away == {"no call came before it": 1}


def test_a_reading_that_drops_out_raises_what_the_vocabulary_says(make_stage: Make) -> None:
    lines = """
        try:
            robot.see()
        except robot.NoImage as error:
            robot.LOG.append(type(error).__name__)
    """
    log, activity = done(make_stage, lines, "dropout", "result")
    assert log == ["NoImage"]
    assert activity.acted == 1
    assert activity.example is not None
    assert activity.example[1].startswith("raises ")
    assert activity.failure is None


def test_a_refusal_is_not_reported_and_all_else_that_is_raised_is(make_stage: Make) -> None:
    lines = "try:\n    robot.move(9)\nexcept robot.Refused:\n    robot.LOG.append('no')"
    log, activity = done(make_stage, lines, "unreported-refusal")
    assert log == []
    assert activity.acted == 1
    assert activity.refusal is None
    with pytest.raises(TypeError):
        done(make_stage, "robot.move('far')", "unreported-refusal")
