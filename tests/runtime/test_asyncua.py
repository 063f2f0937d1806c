"""An OPC-UA client whose node objects tell which command a call is; only where asyncua is installed."""

from __future__ import annotations

import pytest

from tests.runtime.stage import Make

pytest.importorskip("asyncua")

ROBOT = """
    from asyncua import Node as Base

    class Node(Base):
        async def write_attribute(self, attribute, datavalue, indexrange=None):
            self.written = datavalue.Value.Value
"""
PROGRAM = """
    import asyncio
    import robot

    def run():
        node = robot.Node(None, "ns=2;s=Arm.X")
        asyncio.run(node.write_value(1.5))
        return node.written
"""
VOCABULARY = """
    [[operation]]
    call = "asyncua.common.node:Node.write_value"
    message = "self"
    patterns = [
      { text = "ns=2;s=Arm.X", arguments.value = { kind = "translation", unit = "m", mode = "to" } },
    ]
"""


def test_a_write_to_a_node_is_mutated(make_stage: Make) -> None:
    result, activation = make_stage(ROBOT, PROGRAM, VOCABULARY).mutated("reverse", "value")
    assert result == -1.5
    assert activation.mutant.pattern == "ns=2;s=Arm.X"
