"""Campaigns of graded faults find the magnitudes that the tests' own tolerances tell."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.thresholds.brackets import Bracket, MagnitudeResult, bracket_of, seen
from tests.campaign.project import Quiet, request_for, write_project

ROBOT = """
    class Refused(Exception): pass

    class Cell:
        def __init__(self): self.time = 0.0
        def wait(self, seconds):
            self.time += seconds
            return self.tick()
        def tick(self): return self.time

    class Arm:
        def __init__(self, cell): self.cell, self.x = cell, 0.0
        def move_by(self, dx):
            if self.x + dx > 0.34: raise Refused(dx)
            self.x += dx
            self.cell.time += 1.0
            self.cell.tick()
        def look(self): return 0.3
"""
VOCABULARY = """
    refusals = ["robot:Refused"]
    clock = { tick = "robot:Cell.tick", unit = "s" }
    wait = { call = "robot:Cell.wait" }

    [[operation]]
    call = "robot:Arm.move_by"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:Arm.look"
    result = { kind = "position", axis = "x", unit = "m" }

    [[operation]]
    call = "robot:Cell.wait"
    arguments.seconds = { kind = "duration", unit = "s" }
"""
MISSION = """
    def run(cell, arm):
        arm.move_by(0.25)
        cell.wait(0.75)
        return arm.look()
"""
TESTS = """
    import mission
    from robot import Arm, Cell

    def test_run():
        cell = Cell()
        arm = Arm(cell)
        seen = mission.run(cell, arm)
        assert abs(arm.x - 0.25) < 0.015
        assert abs(seen - 0.3) < 0.007
        assert 1.6 < cell.time < 1.85
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Bracket]]:
    """The brackets of a round, by what each ladder's id ends with."""
    folder = write_project(
        tmp_path_factory.mktemp("graded"), MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY
    )
    request = request_for(folder, families=("graded",), rounds=1)
    with Journal.open(run_campaign(request, Quiet())) as journal:
        mutants = {candidate.id: candidate for candidate in journal.mutants()}
        rows: dict[tuple[str, int], dict[float, MagnitudeResult]] = {}
        for outcome in journal.outcomes():
            mutant = mutants[outcome.mutant]
            assert mutant.magnitude is not None
            rows.setdefault((mutant.ladder, outcome.round), {})[mutant.magnitude] = seen(outcome)
    brackets: dict[str, list[Bracket]] = {}
    for (ladder, _), row in rows.items():
        brackets.setdefault(ladder.partition("run:")[2], []).append(bracket_of(row))
    return brackets


@pytest.mark.parametrize(
    ("ladder", "bracket"),
    [
        ("arm.move_by#1:dx:offset=+", Bracket(10.0, 20.0)),
        ("arm.move_by#1:dx:offset=-", Bracket(10.0, 20.0)),
        ("arm.look#1:result:offset=+", Bracket(5.0, 10.0)),
        ("arm.move_by#1:dx:scale=+", Bracket(5.0, 10.0)),  # 0.0125 and 0.025 m
        ("cell.wait#1:seconds:early=-", Bracket(100.0, 200.0)),
        ("arm.move_by#1:call:lag", Bracket(50.0, 100.0)),
        ("arm.look#1:result:drift=+", Bracket(5.0, 10.0)),  # 0.75 s after the first tick
        ("arm.move_by#1:dx:quantise", Bracket(20.0, 100.0)),  # 0.25 m is no multiple of these two alone
    ],
)
def test_the_threshold_is_where_the_test_s_tolerance_puts_it(
    found: dict[str, list[Bracket]], ladder: str, bracket: Bracket
) -> None:
    assert [(bracket_found.low, bracket_found.high) for bracket_found in found[ladder]] == [
        (bracket.low, bracket.high)
    ]


def test_what_the_robot_refuses_is_no_detection(found: dict[str, list[Bracket]]) -> None:
    # 0.25 + 0.1 m is out of reach, and 0.25 + 0.02 m is noticed before
    assert all(bracket_found.refused is None for bracket_found in found["arm.move_by#1:dx:offset=+"])


@pytest.mark.whole
def test_magnitude_and_verdict_agree_in_both_engines(tmp_path: Path) -> None:
    ends = []
    for engine in ("fork", "replay"):
        folder = write_project(tmp_path / engine, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)
        request = request_for(folder, families=("graded",), only=("lag", "drift"), engine=engine)
        with Journal.open(run_campaign(request, Quiet())) as journal:
            ends.append({(outcome.mutant, outcome.round): outcome.verdict for outcome in journal.outcomes()})
    assert ends[0] == ends[1]
    assert ends[0]


@pytest.mark.whole
def test_a_demanded_magnitude_joins_its_ladders_and_is_run_in_every_round(tmp_path: Path) -> None:
    configuration = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=."]
    [[demand]]
    quantity = "dx"
    notice = "12 mm"
    """
    folder = write_project(
        tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY, configuration=configuration
    )
    with Journal.open(run_campaign(request_for(folder, rounds=2), Quiet())) as journal:
        graded = [mutant for mutant in journal.mutants() if mutant.ladder]
        assert {mutant.ladder.rpartition(":")[2] for mutant in graded} == {"offset=+", "offset=-"}
        demanded = {mutant.id for mutant in graded if mutant.magnitude == 12.0}
        ends = {
            (outcome.mutant, outcome.round): seen(outcome)
            for outcome in journal.outcomes()
            if outcome.mutant in demanded
        }
    assert {name.rpartition("=")[2] for name in demanded} == {"+12mm", "-12mm"}
    assert set(ends) == {(name, round) for name in demanded for round in range(2)}
    assert {str(end) for end in ends.values()} == {"missed"}  # the test takes 15 mm
