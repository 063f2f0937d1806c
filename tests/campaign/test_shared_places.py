"""Mutants of the program text whose expression is the very call of an operation, or what it calls."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import REPLAY, VOCABULARY, run, write_project

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
    "last",
    [
        "return arm.position()",
        pytest.param("return (arm.position())", marks=pytest.mark.whole),
        pytest.param("x = arm.position()\n    return x", marks=pytest.mark.whole),
    ],
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


ASYNC_ROBOT = """
    class Arm:
        x = 0.0

        async def move_by(self, dx):
            self.x += dx

        async def position(self):
            return self.x
"""
#: what stands in for the arm has plain functions that return what is to be awaited
AWAITED = """
    import asyncio

    import mission
    from robot import Arm

    class Model:
        def move_by(self, dx):
            return asyncio.sleep(0)

        def position(self):
            return asyncio.sleep(0, result=3.0)

    def test_the_arm():
        assert asyncio.run(mission.run(Arm())) == 0.25

    def test_a_model():
        assert asyncio.run(mission.run(Model())) == 3.0
"""


@pytest.mark.parametrize("families", [("robot",), ("robot", "conventional")])
def test_what_is_awaited_is_awaited_at_a_place_of_the_text_as_well(
    tmp_path: Path, families: tuple[str, ...]
) -> None:
    mission = "async def run(arm):\n    await arm.move_by(0.25)\n    return await arm.position()\n"
    vocabulary = VOCABULARY[VOCABULARY.index("[[operation]]") :]
    project = write_project(tmp_path, mission, AWAITED, robot=ASYNC_ROBOT, vocabulary=vocabulary)
    found = run(project, families=families, only=("robot",), every_test=True)
    negated = found["mission.py:run:arm.position#1:result:negate"]
    assert (negated.verdict, negated.hits) == (Verdict.KILLED, 2)


#: move_left and move_right are counterparts, so what is called is a place of the text itself
COUNTERPARTS = """
    class Arm:
        def __init__(self):
            self.log = []

        def move_left(self, dx):
            self.log.append(dx)

        def move_right(self, dx):
            self.log.append(-dx)
"""
MOVES = """
    [[operation]]
    call = "robot:Arm.move_left"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:Arm.move_right"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
"""
BOTH = """
    import mission
    from robot import Arm

    class Model:
        def __init__(self):
            self.log = []

        def move_left(self, dx):
            self.log.append(dx)

        def move_right(self, dx):
            raise AssertionError

    def test_the_arm():
        arm = Arm()
        mission.run(arm)
        assert arm.log

    def test_a_model():
        model = Model()
        mission.run(model)
        assert model.log == [0.25, 0.5, 1.0]
"""


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_a_call_of_what_has_a_counterpart_keeps_its_sites(tmp_path: Path, engine: str) -> None:
    mission = """
        def run(arm):
            arm.move_left(0.25)
            (arm
             .move_left(0.5))
            go = arm.move_left
            go(1.0)
    """
    project = write_project(tmp_path, mission, BOTH, robot=COUNTERPARTS, vocabulary=MOVES)
    found = run(project, engine=engine, families=("robot", "bugs"), every_test=True)
    alone = run(project, engine=engine, families=("robot",), fresh=True, every_test=True)
    ends = {mutant: (outcome.verdict, outcome.hits) for mutant, outcome in found.items()}
    assert {mutant: ends.get(mutant) for mutant in alone} == {
        mutant: (outcome.verdict, outcome.hits) for mutant, outcome in alone.items()
    }
    kinds = [mutant.rpartition(":")[2] for mutant in alone]
    assert kinds.count("reverse") == 3
    turned = [ends[mutant] for mutant in alone if mutant.endswith(":reverse")]
    assert turned == [(Verdict.KILLED, 2)] * 3
