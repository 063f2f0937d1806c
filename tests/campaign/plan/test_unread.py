"""Values that nobody reads have no reading mutants; what else is done to the same calls stays."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import plan_only
from mutabot.families import CATALOGUE, GRADED, ROBOT
from tests.campaign.project import CONFIGURATION, Quiet, request_for, write_project

ROBOT_PY = """
    import library

    class NoImage(Exception): ...

    class Arm:
        def where(self):
            return 0.5

        def step(self, dx):
            return 0.5

        async def later(self):
            return 0.5

        def look(self):
            return 0.5

        def through(self):
            return library.twice(self)
"""
LIBRARY = """
    def twice(arm):
        return 2 * arm.where()
"""
MISSION = """
    import contextlib

    async def run(arm):
        arm.where()
        (
            arm.where()
        )
        await arm.later()
        arm.step(0.25)
        arm.look()
        arm.through()
        _ = arm.where()
        for dx in range(2): arm.where()
        arm.where() or None
        [arm.where()]
        with contextlib.suppress(arm.where() and ValueError): ...
        (lambda: arm.where())()
        seen = await arm.later()
        return arm.where(), seen
"""
TESTS = """
    import asyncio
    import mission, robot

    def test_it():
        asyncio.run(mission.run(robot.Arm()))
"""
READING = 'result = { kind = "position", axis = "x", unit = "m" }'
VOCABULARY = f"""
    [[operation]]
    call = "robot:Arm.where"
    {READING}

    [[operation]]
    call = "robot:Arm.later"
    {READING}

    [[operation]]
    call = "robot:Arm.step"
    arguments.dx = {{ kind = "translation", axis = "x", unit = "m", mode = "by" }}
    {READING}

    [[operation]]
    call = "robot:Arm.look"
    result = {{ kind = "position", axis = "x", unit = "m", missing = "robot:NoImage" }}
"""
WHY = "the result of the call is not used: it is a statement by itself"


@pytest.mark.needs("catalogue")
def test_readings_of_calls_that_stand_alone_are_left_out(tmp_path: Path) -> None:
    folder = write_project(
        tmp_path, MISSION, TESTS, robot=ROBOT_PY, vocabulary=VOCABULARY, more={"library.py": LIBRARY},
        configuration=CONFIGURATION + "    rounds = 1\n",
    )  # fmt: skip
    families = (ROBOT, CATALOGUE, GRADED)
    planned = plan_only(request_for(folder, families=families, rounds=1), Quiet())
    mutants, left_out = planned.mutants, planned.left_out
    unread = [omission.id.split(":")[2:] for omission in left_out if omission.reason == WHY]
    assert [site for site, *_, operator in unread if operator == "negate"] == [
        "arm.where#1", "arm.where#2", "arm.later#1", "arm.step#1", "arm.look#1", "arm.where#4",
    ]  # fmt: skip
    assert {operator.partition("=")[0] for *_, operator in unread} >= {
        "negate",
        "noise",
        "offset",
        "spike",
    }
    kept = {(mutant.site.text, mutant.site.occurrence) for mutant in mutants if mutant.operator == "negate"}
    assert kept == {
        ("arm.through", 1), ("arm.where", 3), ("arm.where", 5), ("arm.where", 6), ("arm.where", 7),
        ("arm.where", 8), ("arm.later", 2), ("arm.where", 9),
    }  # fmt: skip
    others = {
        mutant.operator for mutant in mutants if (mutant.site.text, mutant.site.occurrence) == ("arm.step", 1)
    }
    assert {"reverse", "skip", "repeat"} <= others
    assert [mutant.operator for mutant in mutants if mutant.site.text == "arm.look"] == ["dropout"]
