"""Campaigns on programs that do everything through one callable."""

from __future__ import annotations

from pathlib import Path

from mutabot.model import Outcome, Verdict
from tests.campaign.project import by_forks, write_project

ROBOT = """
    class Refused(Exception): pass

    class Client:
        def __init__(self, name="cell"): self.name, self.values, self.log = name, {}, []
        def write(self, node, value):
            if node == "x" and abs(value) > 1: raise Refused(value)
            self.values[node] = value
            self.note(node)
        def note(self, node): self.log.append(node)
        def where(self): return 0.25

    class Robot:
        def __init__(self): self.x, self.grip, self.said = 0.0, None, []
        def send(self, cmd):
            if cmd["type"] == "move": self.x += cmd["dx"]
            elif cmd["type"] == "gripper": self.grip = cmd["closed"]
            self.said.append(cmd["type"])
            return len(self.said)
"""
MISSION = """
    def run(client, other, robot):
        client.write("x", 0.5)
        client.write("lamp", True)
        client.write("comment", "hello")
        other.write("lamp", True)
        for cmd in ({"type": "move", "dx": 0.5}, {"type": "gripper", "closed": 1}, {"type": "say"}):
            robot.send(cmd)
"""
TESTS = """
    import mission
    from robot import Client, Robot

    def test_run():
        client, other, robot = Client(), Client("spare"), Robot()
        mission.run(client, other, robot)
        assert (client.values["x"], client.values["lamp"], robot.x, robot.grip) == (0.5, True, 0.5, 1)
        assert robot.said == ["move", "gripper", "say"]
"""
VOCABULARY = """
    refusals = ["robot:Refused"]
    [[operation]]
    call = "robot:Client.write"
    when = { argument = "node", value = "x" }
    arguments.value = { kind = "translation", axis = "x", unit = "m", mode = "to" }
    current = "robot:Client.where"

    [[operation]]
    call = "robot:Client.write"
    when = [{ argument = "node", value = "lamp" }, { argument = "self.name", value = "cell" }]
    arguments.value = { kind = "output", values = [false, true] }

    [[operation]]
    call = "robot:Client.where"
    result = { kind = "position", axis = "x", unit = "m" }

    [[operation]]
    call = "robot:Client.note"

    [[operation]]
    call = "robot:Robot.send"
    when = { argument = "cmd['type']", value = "move" }
    arguments."cmd['dx']" = { kind = "translation", axis = "x", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:Robot.send"
    when = { argument = "cmd['type']", value = "gripper" }
    arguments."cmd['closed']" = { kind = "opening", values = [0, 1] }
    command = false
"""


def found(folder: Path) -> dict[str, Outcome]:
    write_project(folder, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)
    outcomes = by_forks(folder).items()
    return {mutant.split(":", 2)[2].replace("#1", ""): outcome for (mutant, _), outcome in outcomes}


def test_one_callable_is_several_operations_and_other_calls_are_left_alone(tmp_path: Path) -> None:
    outcomes = found(tmp_path)
    wanted = {
        "client.write:node=x/value:reverse": (0.5, -0.5),
        "client.write:node=x/value:by-to": (0.5, 0.75),
        "client.write#2:node=lamp, self.name=cell/value:opposite": (True, False),
        "robot.send:cmd['type']=move/cmd['dx']:reverse": (0.5, -0.5),
        "robot.send:cmd['type']=gripper/cmd['closed']:opposite": (1, 0),
    }
    assert {name: outcomes[name].example for name in wanted} == wanted
    assert {outcomes[name].verdict for name in wanted} == {Verdict.KILLED}
    whole = {
        f"{name}:{operator}"
        for name in (
            "client.write:node=x",
            "client.write#2:node=lamp, self.name=cell",
            "robot.send:cmd['type']=move",
        )
        for operator in ("skip", "repeat")
    }
    # a call that is left alone hides nothing: what it calls in turn is the outermost operation there
    inner = ("client.write#3:call", "other.write:call")
    whole |= {f"{name}:{operator}" for name in inner for operator in ("skip", "repeat")}
    assert {name for name in outcomes if name not in wanted} == whole


def test_calls_that_are_left_alone_may_raise_anything(tmp_path: Path) -> None:
    write_project(
        tmp_path,
        """
        def run(robot):
            robot.go(0.5)
            try:
                robot.go("raise")
            except StopIteration as error:
                return error.value
        """,
        """
        import mission, robot

        def test_run():
            assert mission.run(robot.Robot()) == 7
        """,
        robot="""
        class Robot:
            def go(self, x):
                if x == "raise":
                    raise StopIteration(7)
        """,
        vocabulary="""
        [[operation]]
        call = "robot:Robot.go"
        when = { argument = "x", value = 0.5 }
        arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "by" }
        """,
    )
    verdicts = {outcome.verdict for outcome in by_forks(tmp_path).values()}
    assert verdicts == {Verdict.SURVIVED}
