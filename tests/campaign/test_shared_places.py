"""Mutants of the program text whose expression is the very call of an operation."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import REPLAY, run, write_project

#: what stands in for the arm is of another class: its calls count since the arm is called there, too
TESTS = """
    from types import SimpleNamespace

    import mission
    from robot import Arm

    class Model:
        def __init__(self):
            self.log = []

        def move_by(self, dx):
            self.log.append(dx)

        def position(self):
            return 3.0

    def test_the_arm():
        assert mission.run(Arm()) == 0.0

    def test_a_model():
        assert mission.run(Model()) == 3.0

    def test_functions():
        arm = SimpleNamespace(move_by=lambda dx: None, position=lambda: 1.0)
        assert mission.run(arm) == 1.0
"""


@pytest.mark.parametrize("engine", ["fork", REPLAY])
@pytest.mark.parametrize(
    "last", ["return arm.position()", "return (arm.position())", "x = arm.position()\n    return x"]
)
def test_a_call_that_is_also_a_place_of_the_text_counts_for_whatever_stands_in(
    tmp_path: Path, last: str, engine: str
) -> None:
    mission = f"def run(arm):\n    arm.move_by(0.25)\n    arm.move_by(-0.25)\n    {last}\n"
    project = write_project(tmp_path, mission, TESTS)
    families = ("robot", "conventional")
    found = run(project, engine=engine, families=families, every_test=True)
    negated = found["mission.py:run:arm.position#1:result:negate"]
    assert (negated.verdict, negated.hits) == (Verdict.KILLED, 3)
    # text mutants beside it change nothing: the same mutant, alone, ends alike
    alone = run(project, engine=engine, families=families, only=("robot",), fresh=True, every_test=True)
    assert {mutant: outcome.verdict for mutant, outcome in alone.items()} == {
        mutant: found[mutant].verdict for mutant in alone
    }
