"""Campaigns on cells whose commands are nodes, registers and motions with a switch for relative."""

from __future__ import annotations

from pathlib import Path

from mutabot.model import Verdict
from tests.campaign.engines.test_forking import both_engines
from tests.campaign.project import write_project

ROBOT = """
    class Node:
        def __init__(self, cell, name): self.cell, self.name = cell, name
        def __str__(self): return self.name
        def write_value(self, value): self.cell.values[self.name] = value

    class Cell:
        def __init__(self): self.values, self.x = {}, 0.25
        def node(self, name): return Node(self, name)
        def write(self, address, value): self.values[address] = value
        def where(self): return self.x

        def move(self, x, relative=True):
            self.x = self.x + x if relative else x
            return True
"""
MISSION = """
    def run(cell):
        cell.node("ns=2;s=Arm.X").write_value(0.5)
        cell.node("ns=2;s=Lamp").write_value(True)
        cell.write(40001, 1)
        for relative in (False, True):
            cell.move(0.125, relative)
"""
TESTS = """
    import mission
    from robot import Cell

    def test_run():
        cell = Cell()
        mission.run(cell)
        assert cell.values == {"ns=2;s=Arm.X": 0.5, "ns=2;s=Lamp": True, 40001: 1}
        assert cell.x == 0.25
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Node.write_value"
    message = "self"
    patterns = [
      { text = "ns=2;s=Arm.X", arguments.value = { kind = "translation", unit = "m", mode = "to" } },
      { text = "ns=2;s=Lamp", arguments.value = { kind = "output", values = [false, true] } },
    ]

    [[operation]]
    call = "robot:Cell.write"
    message = "address"
    patterns = [{ text = "40001", arguments.value = { kind = "output", values = [0, 1] } }]

    [[operation]]
    call = "robot:Cell.move"
    current = "robot:Cell.where"
    [operation.arguments.x]
    kind = "translation"
    axis = "x"
    unit = "m"
    mode = { argument = "relative", true = "by", false = "to" }

    [[operation]]
    call = "robot:Cell.where"
    result = { kind = "position", axis = "x", unit = "m" }
"""


def test_nodes_registers_and_modes_are_mutated_alike_by_both_engines(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)
    found = {
        mutant.split(":", 2)[2].replace("#1", ""): both_engine
        for (mutant, _), both_engine in both_engines(tmp_path).items()
    }
    wanted = {
        'cell.node("ns=2;s=Arm.X").write_value:ns=2;s=Arm.X/value:reverse': (0.5, -0.5),
        'cell.node("ns=2;s=Lamp").write_value:ns=2;s=Lamp/value:opposite': (True, False),
        "cell.write:40001/value:opposite": (1, 0),
        "cell.move:relative=false/x:reverse": (0.125, -0.125),
        "cell.move:relative=true/x:reverse": (0.125, -0.125),
        # in the order of the calls: the arm is at 0.25 before the first and at 0.125 before the second
        "cell.move:relative=false/x:by-to": (0.125, 0.375),
        "cell.move:relative=true/x:by-to": (0.125, 0.0),
    }
    examples = {name: outcome.example for name, outcome in found.items()}
    assert {name: examples.get(name) for name in wanted} == wanted
    assert {found[name].verdict for name in wanted} == {Verdict.KILLED}
    assert {found[name].hits for name in wanted} == {1}
