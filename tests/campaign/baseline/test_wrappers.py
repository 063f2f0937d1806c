"""Functions that only pass on what they are called with are named, where several calls share their site."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.baseline.wrappers import passed_on
from mutabot.campaign.checking import check
from tests.campaign.project import Quiet, request_for, write_project


@pytest.mark.parametrize(
    "text",
    [
        "def put(tag, value): write(tag, value)",
        "def put(self, tag, value):\n    'Set a tag.'\n    return self.plc.write(tag, value)",
        "def put(self, value): self.plc.write('clamp', value)",
        "async def put(self, *given, **named): await self.plc.write(*given, **named)",
        "def put(self, value): self.plc.write(value=value)",
    ],
)
def test_a_function_that_only_passes_on_is_found(text: str) -> None:
    assert len(passed_on(text)) == 1


@pytest.mark.parametrize(
    "text",
    [
        "def put(self, value): self.plc.write(2 * value)",
        "def put(self, value):\n    self.check(value)\n    self.plc.write(value)",
        "def stop(self): self.plc.write('stop', 1)",
        "def put(self, value): self.last = self.plc.write(value)",
    ],
)
def test_a_function_that_does_something_itself_is_none(text: str) -> None:
    assert passed_on(text) == frozenset()


ROBOT = """
    class Plc:
        def __init__(self): self.tags = {}
        def write(self, tag, value): self.tags[tag] = value
"""
CELL = """
    class Cell:
        def __init__(self, plc):
            self.plc = plc

        def put(self, tag, value):
            self.plc.write(tag, value)

        def cycle(self):
            self.put("clamp", 1)
            self.put("clamp", 0)
"""
TESTS = """
    import mission, robot

    def test_cycle():
        plc = robot.Plc()
        mission.Cell(plc).cycle()
        assert plc.tags == {"clamp": 0}
"""


@pytest.mark.parametrize(
    ("target", "sites", "is_told"), [("robot:Plc.write", 1, True), ("mission:Cell.put", 2, False)]
)
def test_a_site_of_several_calls_is_reported_until_the_function_is_described(
    tmp_path: Path, target: str, sites: int, is_told: bool
) -> None:
    vocabulary = f'[[operation]]\ncall = "{target}"\n'
    write_project(tmp_path, CELL, TESTS, robot=ROBOT, vocabulary=vocabulary)
    report = check(request_for(tmp_path), Quiet())
    told = [line for line in report.lines if "only passes on" in line]
    assert len(report.data["sites"]) == sites
    assert ["Cell.put, which only passes on what 2 calls give it" in line for line in told] == [
        True
    ] * is_told
