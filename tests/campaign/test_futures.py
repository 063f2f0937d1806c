"""A command that is left out and answers a future: the program waits for what never comes, as it would."""

from __future__ import annotations

import pytest

from mutabot.model import Outcome, Verdict
from tests.campaign.project import CONFIGURATION, run, write_project

ROBOT = """
    import asyncio
    import concurrent.futures

    POOL = concurrent.futures.ThreadPoolExecutor(1)

    class Arm:
        def __init__(self):
            self.x = 0.0

        def _move(self, dx):
            self.x += dx
            return "there"

        def send(self, dx):
            return POOL.submit(self._move, dx)

        def start(self, dx):
            return asyncio.get_running_loop().create_task(self._later(dx))

        def promise(self, dx):
            future = asyncio.get_running_loop().create_future()
            future.set_result(self._move(dx))
            return [future]

        async def _later(self, dx):
            return self._move(dx)
"""
MISSION = """
    import asyncio

    def waits(arm):
        return arm.send(0.25).result(timeout=0.2)

    def forgets(arm):
        arm.send(0.25)

    async def task(arm):
        task = arm.start(0.25)
        assert isinstance(task, asyncio.Task)
        await asyncio.wait_for(task, 0.2)

    async def future(arm):
        future, = arm.promise(0.25)
        done, _ = await asyncio.wait([future], timeout=0.2)
        return bool(done)
"""
TESTS = """
    import asyncio, concurrent.futures
    import mission, robot

    def test_waits():
        assert mission.waits(robot.Arm()) == "there"

    def test_forgets():
        mission.forgets(robot.Arm())

    def test_task():
        asyncio.run(mission.task(robot.Arm()))

    def test_future():
        assert asyncio.run(mission.future(robot.Arm()))
"""
OPERATION = """
    [[operation]]
    call = "robot:Arm.{}"
    arguments.dx = {{ kind = "translation", axis = "x", unit = "m", mode = "by" }}
"""


@pytest.fixture(scope="module")
def skipped(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Outcome]:
    vocabulary = "".join(OPERATION.format(name) for name in ("send", "start", "promise"))
    folder = write_project(
        tmp_path_factory.mktemp("futures"), MISSION, TESTS, robot=ROBOT, vocabulary=vocabulary,
        configuration=CONFIGURATION + "    rounds = 1\n",
    )  # fmt: skip
    outcomes = run(folder, only=("skip",))
    return {name.split(":")[1]: outcome for name, outcome in outcomes.items()}


@pytest.mark.whole
@pytest.mark.parametrize(
    ("function", "verdict", "words"),
    [
        ("waits", Verdict.KILLED, "TimeoutError"),
        ("forgets", Verdict.SURVIVED, ""),
        ("task", Verdict.KILLED, "TimeoutError"),
        ("future", Verdict.KILLED, "assert False"),
    ],
)
def test_a_skipped_call_gives_a_future_that_is_never_done(
    skipped: dict[str, Outcome], function: str, verdict: Verdict, words: str
) -> None:
    outcome = skipped[function]
    assert outcome.verdict is verdict
    assert words in (outcome.message or "")
