"""Coroutines that the program awaits later than it calls, or never: names, and when a call is made."""

from __future__ import annotations

import asyncio
import gc
import warnings
from collections.abc import Callable
from typing import Any
from unittest.mock import AsyncMock, call, create_autospec

import pytest

from tests.runtime.stage import Make, Stage

ROBOT = """
    class Arm:
        def __init__(self):
            self.x = 0.0

        async def move(self, dx):
            self.x += dx

        async def stop(self):
            self.x = 0.0
"""
PROGRAM = """
    import asyncio
    import robot

    async def started(arm):
        task = asyncio.create_task(arm.move(1.0))
        await arm.stop()
        return await task

    async def turned(arm):
        first, second = arm.move(1.0), arm.move(2.0)
        await second
        await first

    async def cancelled(arm):
        task = asyncio.create_task(arm.move(5.0))
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)

    async def named(arm):
        task = asyncio.create_task(arm.move(1.0))
        await task
        return task.get_coro().__qualname__

    async def dropped(arm):
        arm.stop()

    def run():
        asyncio.run(started(robot.ARM))
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Arm.move"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    [[operation]]
    call = "robot:Arm.stop"
    WHEN
"""
NAMES = {"arm": "Arm", "plain mock": "AsyncMockMixin", "mock of the class": "AsyncMockMixin"}


@pytest.fixture(params=["", 'when = { argument = "x", value = "1" }'], ids=["all calls", "some calls"])
def stage(request: pytest.FixtureRequest, make_stage: Make) -> Stage:
    vocabulary = VOCABULARY.replace("WHEN", request.param)
    if request.param:  # none of the calls is meant
        vocabulary = vocabulary.replace('"robot:Arm.stop"', '"robot:Arm.stop"\n    signature = "(x=…)"')
    return make_stage(ROBOT, PROGRAM, vocabulary)


def mock_of(stage: Stage, kind: str) -> Any:
    return AsyncMock() if kind == "plain mock" else create_autospec(stage.load_robot().Arm, instance=True)


@pytest.mark.parametrize("kind", ["plain mock", "mock of the class"])
def test_a_mock_notes_a_call_when_it_is_made_and_its_end_when_it_is_awaited(stage: Stage, kind: str) -> None:
    session = stage.session()

    def after(function: str) -> Any:
        arm = mock_of(stage, kind)
        asyncio.run(stage.run(session, function, arm))
        return arm

    assert after("started").mock_calls == [call.move(1.0), call.stop()]
    arm = after("turned")
    assert arm.move.call_args_list == [call(1.0), call(2.0)]
    assert arm.move.await_args_list == [call(2.0), call(1.0)]
    arm = after("cancelled")
    assert (arm.move.call_count, arm.move.await_count) == (1, 0)


@pytest.mark.parametrize(
    ("operator", "calls"), [("identity", [1.0]), ("reverse", [-1.0]), ("repeat", [1.0, 1.0])]
)
def test_a_mutant_makes_such_a_call_there_too(make_stage: Make, operator: str, calls: list[float]) -> None:
    stage = make_stage(ROBOT, PROGRAM, VOCABULARY.replace("WHEN", ""))
    arm = AsyncMock()
    stage.load_robot().ARM = arm
    quantity = "dx" if operator == "reverse" else None
    stage.mutated(operator, quantity, index=f"{stage.robot_name}:Arm.move")
    made = [made for made in arm.mock_calls if made != call.stop()]
    assert made[1:] == [call.move(dx) for dx in calls]  # after that of the original
    assert arm.mock_calls[2] == call.move(calls[0])


@pytest.mark.parametrize("kind", NAMES)
def test_a_coroutine_has_the_name_of_that_of_the_robot(stage: Stage, kind: str) -> None:
    session = stage.session()
    make: Callable[[], Any] = stage.load_robot().Arm if kind == "arm" else lambda: mock_of(stage, kind)
    assert asyncio.run(stage.run(session, "named", make())).partition(".")[0] == NAMES[kind]
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        asyncio.run(stage.run(session, "dropped", make()))
        gc.collect()
    name = "Arm.stop" if kind == "arm" else "AsyncMockMixin._execute_mock_call"
    assert [str(warning.message) for warning in seen] == [f"coroutine '{name}' was never awaited"]
