"""Enumerations: ``values`` name their members, and what is handed over is a real member."""

from __future__ import annotations

import pytest

from mutabot.model.events import Problem
from tests.runtime.stage import Make, Stage

ROBOT = """
    import enum
    import mujoco

    class Grip(enum.Enum):
        OPEN = "o"
        CLOSED = "c"

    class Level(enum.IntEnum):
        LOW = 0
        HIGH = 1

    class Mode(enum.StrEnum):
        AUTO = "auto"
        HAND = "hand"

    class Light(enum.Flag):
        RED = 1
        GREEN = 2
        BLUE = 4

    class Axis(enum.Enum):
        ROW = (1, 0)
        COLUMN = (0, 1)

    Geom = mujoco.mjtGeom
    SENT = []

    def send(state):
        SENT.append(state)

    def read(state):
        return [state]
"""
PROGRAM = """
    import robot
    from robot import Axis, Geom, Grip, Level, Light, Mode

    def run():
        robot.SENT.clear()
        seen, = robot.read({state})
        robot.send({state})
        return seen, robot.SENT[-1], {other}
"""
VOCABULARY = """
[[operation]]
call = "robot:send"
arguments.state = {{ kind = "output", values = {values} }}

[[operation]]
call = "robot:read"
result."[0]" = {{ kind = "label", values = {values} }}
"""


def stage_of(make_stage: Make, state: str, other: str, values: str) -> Stage:
    return make_stage(ROBOT, PROGRAM.format(state=state, other=other), VOCABULARY.format(values=values))


@pytest.mark.parametrize(
    ("state", "other", "values"),
    [
        ("Grip.OPEN", "Grip.CLOSED", '["OPEN", "CLOSED"]'),
        ("Grip.OPEN", "Grip.CLOSED", '["o", "c"]'),
        ("Grip.CLOSED", "Grip.OPEN", '["Grip.OPEN", "Grip.CLOSED"]'),
        ("Level.LOW", "Level.HIGH", '["LOW", "HIGH"]'),
        ("Level.HIGH", "Level.LOW", "[0, 1]"),
        ("Level.HIGH", "Level.LOW", "[false, true]"),
        ("Mode.AUTO", "Mode.HAND", '["AUTO", "HAND"]'),
        ("Mode.AUTO", "Mode.HAND", '["auto", "hand"]'),
        ("Light.RED", "Light.BLUE", '["RED", "BLUE"]'),
        ("Light.RED | Light.BLUE", "Light.GREEN", '["GREEN", "RED|BLUE"]'),
        ("Light.RED | Light.BLUE", "Light.GREEN", "[2, 5]"),
        ("Axis.ROW", "Axis.COLUMN", '["ROW", "COLUMN"]'),
        ("Geom.mjGEOM_BOX", "Geom.mjGEOM_SPHERE", '["mjGEOM_SPHERE", "mjGEOM_BOX"]'),
        ("Geom.mjGEOM_BOX", "Geom.mjGEOM_SPHERE", "[2, 6]"),
        ("Geom.mjGEOM_BOX", "Geom.mjGEOM_SPHERE", '["mjtGeom.mjGEOM_BOX", "mjtGeom.mjGEOM_SPHERE"]'),
        ("6", "2", "[2, 6]"),
        ("'on'", "'off'", '["off", "on"]'),
    ],
)
@pytest.mark.parametrize(("operator", "quantity"), [("opposite", "state"), ("misread", "[0]")])
def test_a_mutant_hands_over_a_real_member(
    make_stage: Make, state: str, other: str, values: str, operator: str, quantity: str
) -> None:
    stage = stage_of(make_stage, state, other, values)
    (seen, sent, expected), activation = stage.mutated(
        operator, quantity, index=1 if operator == "opposite" else 0
    )
    changed, kept = (sent, seen) if operator == "opposite" else (seen, sent)
    assert (changed, type(changed)) == (expected, type(expected))
    assert kept != expected
    assert activation.activity.acted == 1
    assert not [line for line in stage.writer.lines if isinstance(line, Problem)]


@pytest.mark.parametrize(
    ("state", "values", "words"),
    [
        (
            "Grip.OPEN",
            '["OPEN", "CLOSE"]',
            "Grip has no member 'CLOSE', which values name; did you mean 'CLOSED'?",
        ),
        ("Grip.OPEN", "[0, 1]", "Grip has no member 0, which values name; it has OPEN, CLOSED"),
        ("Level.LOW", "[0, 2]", "Level has no member 2, which values name; it has LOW, HIGH"),
        ("Light.RED", "[1, 8]", "Light has no member 8, which values name; it has RED, GREEN, BLUE"),
        ("Grip.OPEN", '["OPEN", "o"]', "values name OPEN of Grip twice"),
        (
            "Geom.mjGEOM_BOX",
            '["mjGEOM_SPHER", "mjGEOM_BOX"]',
            "mjtGeom has no member 'mjGEOM_SPHER', which values name; did you mean 'mjGEOM_SPHERE'?",
        ),
    ],
)
def test_a_value_that_no_member_fits_is_a_problem(
    make_stage: Make, state: str, values: str, words: str
) -> None:
    stage = stage_of(make_stage, state, "0", values)
    session = stage.session(inspect=True)
    stage.run(session)
    session.inspect_targets()
    told = {(line.key, line.text) for line in stage.writer.lines if isinstance(line, Problem)}
    assert told == {("arguments.state", words), ("result.[0]", words)}


def test_a_member_that_is_none_of_the_values_is_left_alone(make_stage: Make) -> None:
    stage = stage_of(make_stage, "Light.GREEN", "0", '["RED", "BLUE"]')
    (seen, _, _), activation = stage.mutated("misread", "[0]")
    assert seen.name == "GREEN"
    assert (activation.activity.acted, list(activation.activity.away)) == (
        0,
        ["it is not one of the values that the vocabulary gives"],
    )
