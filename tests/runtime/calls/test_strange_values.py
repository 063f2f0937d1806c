"""Objects that nobody may look into: they are asked for nothing, and stay as they are."""

from __future__ import annotations

import pytest

from mutabot.model.events import Problem, Remark
from tests.runtime.stage import Make, Stage

ROBOT = """
ASKED = []
class Touchy:
    def __getattribute__(self, name):
        if name == "__class__":
            ASKED.append(name)
        return object.__getattribute__(self, name)
    def _asked(self, *_):
        ASKED.append("asked")
        raise RuntimeError("it has a unit")
    __getattr__ = __eq__ = __hash__ = __bool__ = __float__ = __int__ = __repr__ = __len__ = _asked
    tolist = _asked
    dtype = shape = property(_asked)
class Wrong:
    @property
    def number(self): raise RuntimeError("the bus is down")
class Arm:
    def __init__(self): self.told, self.x = [], Touchy()
    def move_by(self, dx): self.told.append(dx); return self.x
    def push(self, force): return None
    def where(self): return self.x
"""
PROGRAM = """
import robot
def run(arm):
    given = robot.Touchy()
    assert arm.move_by(given) is arm.x
    assert arm.told[-1] is given
    assert arm.where() is arm.x
    arm.push(robot.Wrong())
"""
VOCABULARY = """
[[operation]]
call = "robot:Arm.move_by"
arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
[[operation]]
call = "robot:Arm.push"
arguments."force.number" = { kind = "force", unit = "N" }
[[operation]]
call = "robot:Arm.where"
result = { kind = "position", axis = "x", unit = "m" }
"""


@pytest.fixture
def stage(make_stage: Make) -> Stage:
    return make_stage(ROBOT, PROGRAM, VOCABULARY)


@pytest.mark.parametrize("record", [False, True])
def test_a_recorded_call_asks_its_values_nothing(stage: Stage, record: bool) -> None:
    session = stage.session(record=record, inspect=True)
    stage.run(session, "run", stage.load_robot().Arm())
    session.inspect_targets()
    assert stage.load_robot().ASKED == []
    assert [hit[1:3] for hit in session.recorder.trace] == [({}, {})] * 3


def test_it_is_said_once_what_to_describe_instead(stage: Stage) -> None:
    session = stage.session(inspect=True)
    for _ in range(2):
        stage.run(session, "run", stage.load_robot().Arm())
    session.finish()
    said = [line for line in stage.writer.lines if isinstance(line, Remark) and "not plain data" in line.text]
    assert sorted(line.key for line in said) == ["arguments.dx", "result.result"]
    (problem,) = (line for line in stage.writer.lines if isinstance(line, Problem))
    assert "the bus is down" in problem.text


@pytest.mark.parametrize("operator", ["repeat", "identity"])
def test_a_mutated_call_asks_its_values_nothing(make_stage: Make, operator: str) -> None:
    program = PROGRAM.replace("def run(arm):", "ARM = robot.Arm()\ndef run(arm=ARM):")
    stage = make_stage(ROBOT, program, VOCABULARY)
    _, active = stage.mutated(operator)
    assert active.activity.hits == 1
    assert active.activity.acted == (operator == "repeat")
    assert active.activity.failure is None
    assert stage.load_robot().ASKED == []


@pytest.mark.parametrize("kind", ["decimal:Decimal", "fractions:Fraction"])
@pytest.mark.parametrize("operator", ["noise", "negate", "reverse"])
def test_operators_leave_exact_numbers_what_they_are(make_stage: Make, kind: str, operator: str) -> None:
    module, _, name = kind.partition(":")
    program = f"""
        import robot
        from {module} import {name}
        def run():
            arm = robot.Arm()
            arm.x = {name}("0.5")
            arm.move_by({name}("0.25"))
            return arm.told[0], arm.where()
    """
    stage = make_stage(ROBOT, program, VOCABULARY)
    quantity, index = ("dx", 0) if operator == "reverse" else ("result", 1)
    (told, read), active = stage.mutated(operator, quantity, index=index)
    assert active.activity.acted == 1
    assert type(told).__name__ == type(read).__name__ == name
    assert (told == -0.25) is (operator == "reverse")
    assert (read == 0.5) is (operator == "reverse")
