"""A small campaign with every kind of verdict, for the tests of analysis, reports and command line."""

from __future__ import annotations

import time
from pathlib import Path as File
from typing import Any

from mutabot.journal.journal import Journal
from mutabot.journal.records import BaselineTest, ControlEnd
from mutabot.model import (
    By,
    Check,
    Compared,
    Kind,
    LeftOut,
    Looked,
    Mode,
    Mutant,
    Operation,
    Outcome,
    Path,
    Quantity,
    Role,
    Site,
    Span,
    Verdict,
    Vocabulary,
)
from mutabot.model.codec import to_data
from mutabot.model.events import TestEnd

LOOKED = (
    Looked(
        "tests/test_box.py::test_arrives",
        acted=True,
        checks=(
            Check("tests/test_box.py:7", "x == approx(0.5, abs=0.1)", "0.48 == approx(0.5)", 0.08, times=2),
            Check("tests/test_box.py:8", "box.colour == [red]"),
        ),
    ),
    Looked("tests/test_box.py::test_leaves", acted=False),
)
PROGRAM = """\
def run(arm, gripper):
    gripper.command(0)
    arm.move_by(dx=0.2)
    naïve = "größe"; arm.move_by(dx=-0.3)
    gripper.command(1)
"""
SENSORS = """\
def box():
    return tracker.box_position()
"""
X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, axis="x", unit="m", frame="world")
DX = Quantity("dx", Path.parse("dx", rooted=True), Kind.TRANSLATION, axis="x", unit="m", mode=Mode.BY)
VOCABULARY = Vocabulary(
    operations=(
        Operation("robot:Arm.move_by", arguments=(DX,)),
        Operation("robot:Gripper.command"),
        Operation("tracker:box_position", result=(X,), command=False),
    )
)


def site(file: str, line: int, text: str, role: Role, *, occurrence: int = 1, column: int = 4) -> Site:
    width = {"tracker.box_position": 22, "gripper.command": 18}.get(text, 20)
    return Site(Span(file, line, column, line, column + width, "run"), text, occurrence, role)


def mutant(number: int, operator: str, at: Site, quantity: str | None, description: str) -> Mutant:
    operation = {"a": "robot:Arm.move_by", "g": "robot:Gripper.command"}.get(
        at.text[0], "tracker:box_position"
    )
    return Mutant(number, "robot", operator, at, operation, None, quantity, "", description)


OPEN = site("mission.py", 2, "gripper.command", Role.PROGRAM)
MOVE = site("mission.py", 3, "arm.move_by", Role.PROGRAM)
BACK = site("mission.py", 4, "arm.move_by", Role.PROGRAM, occurrence=2, column=24)
READ = site("tests/sensors.py", 2, "tracker.box_position", Role.ORACLE, column=11)

REVERSE = mutant(1, "reverse", MOVE, "dx", "arm.move_by: dx 0.2 m → -0.2 m")
SKIP = mutant(2, "skip", OPEN, None, "gripper.command: do nothing")
BY_TO = mutant(3, "by-to", BACK, "dx", "arm.move_by: dx by -0.3 m → to -0.3 m")
NEGATE = mutant(4, "negate", READ, ".x", "tracker.box_position: negate x")
NOISE = mutant(5, "noise", READ, ".x", "tracker.box_position: noise on x (standard deviation 1 m)")
MUTANTS = (REVERSE, SKIP, BY_TO, NEGATE, NOISE)
LEFT_OUT = (
    LeftOut("mission.py:run:arm.move_by#1:dy:reverse", "arm.move_by: reverse dy", "it is always 0"),
    LeftOut("mission.py:run:arm.move_by#2:dy:reverse", "arm.move_by: reverse dy", "it is always 0"),
)
TEST = "tests/test_mission.py::test_box_arrives"

OUTCOMES = (
    Outcome(
        REVERSE.id, 0, Verdict.KILLED, By.CHECK, test=TEST, exception="builtins:AssertionError",
        message="box is at x = 0.55 m\nassert False", place="tests/test_mission.py:9", hits=1, acted=1,
        example=(0.2, -0.2), tests=1, wall=1.5,
    ),
    Outcome(REVERSE.id, 1, Verdict.KILLED, By.EXCEPTION, test=TEST, exception="robot:Stop", message="hit"),
    Outcome(SKIP.id, 0, Verdict.SURVIVED, indistinguishable=True, distance=0.0, hits=1, acted=1, tests=2),
    Outcome(
        SKIP.id, 1, Verdict.SURVIVED, indistinguishable=False, distance=312.0, hits=1, acted=1, tests=2,
        divergence=("box_position.x: 0.8 instead of 0.488 (off by 0.312)",),
    ),
    Outcome(BY_TO.id, 0, Verdict.REFUSED, test=TEST, message="x = −0.3 m is out of reach by 0.1 m"),
    Outcome(BY_TO.id, 1, Verdict.TIMEOUT, test=TEST, message="over 1000 operations"),
    Outcome(
        NEGATE.id, 0, Verdict.SURVIVED, indistinguishable=True, distance=0.0, example=(0.0014, -0.0014),
        hits=3, acted=3, tests=2, compared=Compared(calls=3, moments=1, returned=2), looked=LOOKED,
    ),
    Outcome(NEGATE.id, 1, Verdict.KILLED, By.CHECK, test=TEST, message="assert False"),
    Outcome(NOISE.id, 0, Verdict.ERROR, message="the simulator gave NaN [bold]not markup[/bold]"),
    Outcome(NOISE.id, 1, Verdict.NOT_COVERED),
)  # fmt: skip


def meta(**changes: Any) -> dict[str, Any]:
    return {
        "mutabot": "0.1.0", "python": "3.11", "versions": {"pytest": "9"}, "root": "/nowhere", "seed": 7,
        "rounds": 2, "engine": "replay", "jobs": 2, "started": time.time(), "vocabulary": to_data(VOCABULARY),
        "draws": ["noise"],
        **changes,
    }  # fmt: skip


def write_journal(
    path: File,
    *,
    outcomes: tuple[Outcome, ...] = OUTCOMES,
    mutants: tuple[Mutant, ...] = MUTANTS,
    finish: str | None = "complete",
    **changes: Any,
) -> File:
    """A journal as a campaign would write it."""
    with Journal.create(path, meta=meta(**changes)) as journal:
        journal.add_tests(BaselineTest(round, 0, TestEnd(TEST, "passed", wall=0.5)) for round in range(2))
        journal.set_plan(mutants, LEFT_OUT, sources={"mission.py": PROGRAM, "tests/sensors.py": SENSORS})
        for control in ("identity", "fatal"):
            journal.add_control(ControlEnd("tests/test_mission.py", control, True, "as it must"))
        for outcome in outcomes:
            journal.add_outcome(outcome)
        if finish is not None:
            journal.finish(finish)
    return path
