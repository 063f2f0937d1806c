"""Probes along the way: a fault that is seen on the way alone is told, and reading them changes nothing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.comparison import Observation, TraceCall, compare
from mutabot.campaign.probe_readings import probe_intervals_of
from mutabot.campaign.run import run_campaign
from mutabot.execution.processes import _template
from mutabot.model import Outcome, Probe, Verdict, Vocabulary
from mutabot.model.events import TestEnd
from tests.campaign.project import ROBOT, VOCABULARY, Quiet, by_forks, outcomes, request_for, write_project

MISSION = """
    def run(arm):
        str(arm.position())
        arm.move_by(0.25)
        arm.move_to(0.5)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_it_arrives():
        arm = Arm(0.125)
        mission.run(arm)
        assert arm.x == 0.5
"""
MORE = """
    [[operation]]
    call = "robot:Arm.move_to"
    arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "to" }

    [[probe]]
    call = "robot:Arm.where"
    tolerance = 0.001
"""
METHODS = """
        def move_to(self, x):
            self.x = x

        def where(self):
            return self.x
"""


def project(folder: Path, robot: str = ROBOT + METHODS) -> Path:
    return write_project(folder, MISSION, TESTS, robot=robot, vocabulary=VOCABULARY + MORE)


def named(found: dict[tuple[str, int], Outcome], part: str) -> Outcome:
    return next(value for (mutant, _), value in found.items() if part in mutant)


def test_a_fault_that_is_seen_on_the_way_alone_is_reported(tmp_path: Path) -> None:
    found = by_forks(project(tmp_path))
    reverse = named(found, "move_by#1:dx:reverse")
    assert (reverse.verdict, reverse.indistinguishable) == (Verdict.SURVIVED, False)
    assert (reverse.distance, reverse.way) == (0.0, pytest.approx(500))
    (line,) = reverse.divergence
    assert line.startswith("on the way, after call 2, mission.py:4 ")
    assert line.endswith("Arm.move_by: Arm.where: -0.125 instead of 0.375 (off by 0.5)")
    negate = named(found, "position#1:result:negate")
    assert (negate.indistinguishable, negate.way) == (True, 0.0)
    assert negate.compared is not None
    assert (negate.compared.calls, negate.compared.moments) == (3, 3)


@pytest.mark.whole
def test_a_fork_is_compared_on_the_way_in_the_tests_after_its_own_too(tmp_path: Path) -> None:
    folder = project(tmp_path)
    tests = folder / "tests" / "test_mission.py"
    tests.write_text(tests.read_text() + "\n\ndef test_it_arrives_again():\n    test_it_arrives()\n")
    only = ("*position#1:result:negate", "*move_by#1:dx:reverse")
    forked = by_forks(folder, only=only)
    replayed = by_forks(folder, only=only, engine="replay", fresh=True)
    for pair, outcome in forked.items():
        assert outcome.engine == "fork"
        assert outcome.compared is not None
        assert (outcome.compared.calls, outcome.compared.moments) == (6, 6)
        assert (outcome.compared, outcome.way) == (replayed[pair].compared, replayed[pair].way)


@pytest.mark.parametrize(
    ("body", "why"),
    [
        (
            "self.count = getattr(self, 'count', 0) + 1\n            return self.count",
            "changes when it is read",
        ),
        ("import random\n            random.random()\n            return self.x", "draws random numbers"),
        ("import time\n            time.sleep(0.06)\n            return self.x", "reading them takes"),
    ],
)
def test_a_probe_that_changes_something_or_is_slow_is_read_at_the_end_alone(
    tmp_path: Path, body: str, why: str
) -> None:
    folder = project(tmp_path, robot=ROBOT + METHODS.replace("return self.x", body))
    progress = Quiet()
    found = outcomes(run_campaign(request_for(folder, only=("*reverse*",)), progress))
    told = [line for line in progress.lines if "not along the way" in line]
    assert len(told) == 1
    assert why in told[0]
    assert {outcome.way for outcome in found} == {None}


def test_one_fork_server_serves_jobs_with_and_without_readings_along_the_way(tmp_path: Path) -> None:
    request = request_for(project(tmp_path))
    assert _template(request.job(0)) == _template(request.job(0, moments={"t": 4}))


def moved(*places: float, key: str = "a") -> Observation:
    events = [TraceCall(key) for _ in places]
    moments = [(number, {"w:p.x": place, "w:p.y": 0.0}, True) for number, place in enumerate(places, start=1)]
    changes = [
        (call, parts if call == 1 else {"w:p.x": parts["w:p.x"]}, call == 1) for call, parts, _ in moments
    ]
    return Observation(events, {"w:p.x": 9.0}, moments=changes)


def test_the_worst_moment_is_reported_with_its_call() -> None:
    found = compare(moved(0.0, 1.0, 2.0), moved(0.1, 1.5, 2.0), [Probe("w:p", 0.01)])
    assert (found.distance, found.way, found.compared.moments) == (0.0, pytest.approx(50), 4)
    assert found.divergence == ("on the way, after call 2, a: p.x: 1.5 instead of 1 (off by 0.5)",)


def test_moments_are_compared_as_long_as_the_calls_are_the_same() -> None:
    found = compare(moved(0.0, 1.0), moved(5.0, 5.0, key="b"), [Probe("w:p", 0.01)])
    assert found.way is None
    assert found.divergence == ("call 1: b instead of a",)


def test_a_first_run_that_was_not_read_along_the_way_is_equal_to_one_that_was() -> None:
    read = moved(0.0, 1.0)
    baseline = Baseline(ends={(0, "t"): TestEnd("t", "passed")})
    baseline.observations[0, "t"] = replace(read, moments=())
    vocabulary = Vocabulary((), probes=(Probe("w:p", 0.01),))
    baseline.compare_runs(0, TestEnd("t", "passed"), read, vocabulary)
    assert baseline.inexact == set()
    assert baseline.observations[0, "t"] == read
    baseline.compare_runs(0, TestEnd("t", "passed"), moved(0.0, 1.0 + 1e-9), vocabulary)
    assert baseline.inexact == {(0, "t")}


def test_the_cost_of_a_reading_decides_how_often() -> None:
    def end(reading: float | None, commands: int = 40, cpu: float = 1.0, why: str | None = None) -> TestEnd:
        return TestEnd("t", "passed", commands=commands, cpu=cpu, reading=reading, not_along=why)

    def stride(*ends: TestEnd) -> int | None:
        return (
            probe_intervals_of({(round, "t"): outcome for round, outcome in enumerate(ends)})
            .get(0, {})
            .get("t")
        )

    assert stride(end(0.0001)) == 1
    assert stride(end(0.0005)) == 4
    assert stride(end(0.0005, cpu=0.01)) == 4  # five milliseconds are always allowed
    assert stride(end(0.1)) is None
    assert stride(end(None)) is None
    assert stride(end(0.0001, commands=0)) is None
    assert stride(end(0.0001), end(None, why="it draws random numbers")) is None
