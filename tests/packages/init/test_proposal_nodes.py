"""``mutabot init`` on calls that a node, a register or a name tells apart."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.checking import check
from mutabot.config.vocabulary import load_vocabulary
from mutabot.model import Kind
from mutabot_init.observations import WatchedCallable
from mutabot_init.propose import propose
from mutabot_init.watching.callee import any_method
from mutabot_init.watching.watch import _command, _Seen
from tests.campaign.project import Quiet, request_for

FIELDBUS = """
    class Node:
        VALUES = {"ns=2;s=Gauge.Height": 0.03, "ns=2;s=Door.IsOpen": True}
        def __init__(self, name): self.name = name
        def __str__(self): return self.name
        async def write_value(self, value): self.VALUES[self.name] = value
        async def read_value(self): return self.VALUES[self.name]

    class Registers:
        def write_register(self, address, value): ...
        def write_text(self, address, text): ...

    class Arm:
        def __init__(self): self.x = 0.0
        def __str__(self): return f"Arm at {self.x}"
        def set_x(self, x): self.x = x
"""
CELL = """
    import asyncio
    from fieldbus import Arm, Node, Registers

    async def nodes():
        belt, gate = Node("ns=2;s=Belt.Speed"), Node("ns=2;s=Gate.Open")
        await belt.write_value(0.5)
        await gate.write_value(True)
        await Node("ns=2;s=Arm.X").write_value(0.25)
        await belt.write_value(0.0)
        return await Node("ns=2;s=Gauge.Height").read_value(), await Node("ns=2;s=Door.IsOpen").read_value()

    def run():
        for value in (100, 200):
            Registers().write_register(40001, value)
        Registers().write_register(40007, True)
        for number in range(40):
            Registers().write_text(number, "ready")
        Arm().set_x(0.5)
        return asyncio.run(nodes())
"""
TEST = "import cell\ndef test_it(): assert cell.run() == (0.03, True)\n"


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cell")
    for name, text in {"fieldbus.py": FIELDBUS, "cell.py": CELL, "tests/test_cell.py": TEST}.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(textwrap.dedent(text))
    propose(folder)
    return folder


def operation(project: Path, name: str) -> Any:
    return load_vocabulary(["robot.toml"], project).operation(f"fieldbus:{name}")


def test_the_nodes_of_an_object_are_commands_with_what_is_written_beside_them(project: Path) -> None:
    found = {pattern.text: pattern.arguments for pattern in operation(project, "Node.write_value").patterns}
    assert {
        text: [(quantity.kind, quantity.axis, quantity.values) for quantity in written]
        for text, written in found.items()
    } == {
        "ns=2;s=Belt.Speed": [(Kind.OUTPUT, None, (0.5, 0.0))],
        "ns=2;s=Gate.Open": [(Kind.OUTPUT, None, (False, True))],
        "ns=2;s=Arm.X": [(Kind.TRANSLATION, "x", None)],
    }


def test_what_a_node_reads_is_identified_by_its_name_and_values(project: Path) -> None:
    reading = operation(project, "Node.read_value")
    assert not reading.command
    assert {pattern.text: [part.kind for part in pattern.result] for pattern in reading.patterns} == {
        "ns=2;s=Gauge.Height": [Kind.DISTANCE],
        "ns=2;s=Door.IsOpen": [Kind.FLAG],
    }


def test_registers_are_distinguished_by_their_numbers(project: Path) -> None:
    writing = operation(project, "Registers.write_register")
    assert {pattern.text: [part.values for part in pattern.arguments] for pattern in writing.patterns} == {
        "40001": [(100, 200)],
        "40007": [(False, True)],
    }


def test_an_object_whose_text_changes_is_no_node(project: Path) -> None:
    found = operation(project, "Arm.set_x")
    assert [argument.name for argument in found.arguments] == ["x"]
    assert found.message is None


def test_check_accepts_commands_that_nodes_distinguish(project: Path) -> None:
    report = check(request_for(project), Quiet())
    assert report.data["unused"] == []


def test_more_names_than_a_list_of_commands_has_are_given_up() -> None:
    seen = _Seen(any_method("send"), WatchedCallable("*:*.send"))
    for number in range(30):
        _command(seen, None, {"channel": number, "value": 1})
    assert seen.call.discriminator == ""
    assert not seen.call.commands


ONE, SEVERAL = {"tag": "Belt.Run", "value": True}, {"tag": [("Belt.Run", False), ("Belt.Speed", 0.0)]}


@pytest.mark.parametrize(
    ("calls", "commands", "others"),
    [
        pytest.param([ONE, ONE, SEVERAL], ["Belt.Run"], 1, id="a list at the end"),
        pytest.param([SEVERAL, ONE, ONE], ["Belt.Run"], 1, id="a list first"),
        pytest.param([SEVERAL, ONE, {"tag": None}, ONE, ONE], ["Belt.Run"], 2, id="what names nothing"),
        pytest.param([ONE, SEVERAL], [], 1, id="as many lists as names"),
    ],
)
def test_names_are_commands_if_most_calls_have_one(
    calls: list[dict[str, Any]], commands: list[str], others: int
) -> None:
    seen = _Seen(any_method("write"), WatchedCallable("*:*.write"))
    for values in calls:
        _command(seen, None, values)
    assert [*seen.call.commands] == commands
    assert seen.call.other_commands == others


def test_the_draft_says_which_calls_are_no_commands_of_it(tmp_path: Path) -> None:
    files = {
        "plc.py": "class PLC:\n    def Write(self, tag, value=None): self.last = tag\n",
        "line.py": "from plc import PLC\n\ndef run(plc=PLC()):\n    plc.Write('Valve.Open', True)\n"
        "    plc.Write('Valve.Open', False)\n    plc.Write([('Belt.Run', False), ('Belt.Speed', 0.0)])\n",
        "tests/test_line.py": "import line\ndef test_it(): line.run()\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    propose(tmp_path)
    assert "# 1 more call without one name in tag" in (tmp_path / "robot.toml").read_text()
    (writing,) = load_vocabulary(["robot.toml"], tmp_path).operations
    assert {pattern.text: [part.values for part in pattern.arguments] for pattern in writing.patterns} == {
        "Valve.Open": [(False, True)]
    }
