"""Campaigns on robots that refuse commands by data."""

from __future__ import annotations

from pathlib import Path

from mutabot.model import Verdict
from tests.campaign.project import by_forks, write_project

ROBOT = """
    from dataclasses import dataclass

    @dataclass
    class Reply:
        status: int
        text: str = ""

    class Arm:
        def __init__(self): self.x = 0.0

        def move_to(self, x):
            if x < 0: return Reply(5, "behind the wall")
            self.x = x
            return Reply(0)

        def lift(self, z): return -1 < z < 1

        def height(self): return 0.5

        def turn(self, angle): return Reply(0)
"""
MISSION = """
    def run(arm):
        reply = arm.move_to(0.5)
        if reply.status:
            raise RuntimeError(reply.text)

    def careful(arm):
        reply = arm.move_to(0.25)
        return reply.status

    def lift(arm):
        return arm.lift(0.75)

    def turn(arm):
        return arm.turn(0.5)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_run():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.5

    def test_careful():
        mission.careful(Arm())

    def test_lift():
        assert mission.lift(Arm())

    def test_turn():
        assert mission.turn(Arm()).status == 0
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Arm.move_to"
    arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "to" }
    refused = { path = "status", values = [5, 6] }

    [[operation]]
    call = "robot:Arm.lift"
    arguments.z = { kind = "translation", axis = "z", unit = "m", mode = "to" }
    current = "robot:Arm.height"
    refused = { values = [false] }

    [[operation]]
    call = "robot:Arm.height"
    result = { kind = "position", axis = "z", unit = "m" }

    [[operation]]
    call = "robot:Arm.turn"
    arguments.angle = { kind = "rotation", axis = "z", unit = "rad", mode = "by" }
    refused = { path = "status", values = [0] }
"""


def test_a_command_that_is_refused_by_data_is_never_a_kill(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)
    outcomes = {
        mutant.split(":", 1)[1].replace("#1", ""): by_fork
        for (mutant, _), by_fork in by_forks(tmp_path).items()
    }
    told = {name: (outcome.verdict, outcome.message) for name, outcome in outcomes.items()}
    refused = Verdict.REFUSED
    assert told["run:arm.move_to:x:reverse"] == (refused, "answered status 5")
    assert told["careful:arm.move_to:x:reverse"] == (refused, "answered status 5")
    assert told["lift:arm.lift:z:by-to"] == (refused, "answered False")
    # a mutant that is taken is judged by the tests as ever
    assert told["lift:arm.lift:z:reverse"][0] is Verdict.SURVIVED
    assert told["run:arm.move_to:call:skip"][0] is Verdict.KILLED
    # where the original is refused as well, its tests judge the mutant
    assert told["turn:arm.turn:angle:reverse"][0] is Verdict.SURVIVED
    assert told["turn:arm.turn:call:skip"][0] is Verdict.SURVIVED
