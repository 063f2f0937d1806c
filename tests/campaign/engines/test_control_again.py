"""Controls: where they act, and what follows from one that ends wrongly."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.controls import FATAL, IDENTITY, IMPORT, ForkTrust, controls_of
from mutabot.campaign.run import run_campaign
from mutabot.errors import ControlError
from mutabot.families import CALLS
from mutabot.faults import Planned, PlannedMutant
from mutabot.model import Mutant, Outcome, Role, Site, Span, Verdict
from mutabot.model.activation import Activation
from mutabot.model.events import TestEnd
from mutabot.model.mutant import Place
from tests.campaign.project import CONFIGURATION, REPLAY, Quiet, outcomes, request_for, write_project
from tests.campaign.scripted import CHECKED, Died, Run, Script

#: hangs in what is neither the baseline nor a fork parent: these are copies of the process that imported it
MISSION = """
    import os
    import time

    IMPORTED_BY = os.getpid()

    def get_stuck():
        time.sleep(3600)

    def run(arm):
        arm.move_by(0.5)
        if os.getppid() != IMPORTED_BY:
            get_stuck()
"""
TESTS = """
    import mission
    from robot import Arm

    def test_moves():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.5
"""


def project(folder: Path, mission: str) -> None:
    write_project(folder, mission, TESTS, configuration=CONFIGURATION + "    timeout_seconds = 2\n")


def test_a_control_that_hangs_once_does_not_end_the_campaign(tmp_path: Path, script: Script) -> None:
    hangs = Died(overdue="no end after 2 s of wall clock", acted=False)
    script.control = lambda run: None if run.before else hangs
    project(tmp_path, MISSION)
    progress = Quiet()
    run_campaign(request_for(tmp_path, engine="replay", only=("*:reverse",)), progress)
    lines = [line for line in progress.lines if "ended wrongly once" in line]
    assert {line.partition(" (")[0] for line in lines} == {
        "the identity control of tests/test_mission.py ended wrongly once",
        "the fatal control of tests/test_mission.py ended wrongly once",
    }
    assert all("no end after 2 s of wall clock" in line for line in lines)


@pytest.mark.parametrize("engine", ["replay", "fork"])
def test_a_suite_that_waits_for_ever_for_what_the_fatal_control_ended_shows_that_it_acted(
    tmp_path: Path, script: Script, engine: str
) -> None:
    hangs = Died(overdue="no end after 2 s of wall clock")
    script.control = lambda run: hangs if run.mutant is not None and run.mutant.operator == FATAL else None
    project(tmp_path, MISSION)
    progress = Quiet()
    run_campaign(request_for(tmp_path, engine=engine, only=("*:reverse",)), progress)
    assert not [line for line in progress.lines if "ended wrongly" in line]


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_where_the_suite_lets_exceptions_pass_calls_that_are_missing_show_that_the_fatal_control_acted(
    tmp_path: Path, engine: str
) -> None:
    mission = """
        def run(arm):
            arm.move_by(0.5)
            return arm.position()
    """
    tests = """
        import mission
        from robot import Arm

        def test_whatever_comes():
            try:
                assert mission.run(Arm()) == 0.5
            except BaseException:
                pass
    """
    write_project(tmp_path, mission, tests)
    progress = Quiet()
    path = run_campaign(request_for(tmp_path, engine=engine, only=("*:reverse",)), progress)
    assert [outcome.verdict for outcome in outcomes(path)] == [Verdict.SURVIVED]
    assert not [line for line in progress.lines if "ended wrongly" in line]


def test_a_control_that_hangs_twice_ends_the_campaign(tmp_path: Path) -> None:
    project(tmp_path, MISSION)
    with pytest.raises(ControlError, match="no verdict of this campaign could be believed") as caught:
        run_campaign(request_for(tmp_path, engine="auto", only=("*:reverse",)), Quiet())
    assert "no end after 2 s of wall clock" in str(caught.value)


def test_a_test_that_fails_under_the_identity_is_named_with_one_line_of_its_message(
    tmp_path: Path, script: Script
) -> None:
    late = {"outcome": "failed", "exception": "builtins:AssertionError", "message": "late\nby 16 ms"}
    script.control = lambda run: late if is_identity(run) else None
    project(tmp_path, MISSION)
    with pytest.raises(ControlError) as caught:
        run_campaign(request_for(tmp_path, engine="replay", only=("*:reverse",)), Quiet())
    first, _, last = str(caught.value).partition(" ended wrongly in tests/test_mission.py::test_moves: ")
    assert first.startswith("the identity control of tests/test_mission.py at ")
    assert "late; no verdict" in last
    assert last.endswith("if that test fails by chance or load, deselect it")


IN_ORDER = """
    import mission
    from robot import Arm

    def test_first():
        mission.first(Arm())

    def test_second():
        mission.second(Arm())

    def test_third():
        mission.first(Arm())
"""
FUNCTIONS = """
    def first(arm):
        arm.move_by(0.5)

    def second(arm):
        arm.move_by(0.5)
"""
SECOND, THIRD = "tests/test_mission.py::test_second", "tests/test_mission.py::test_third"


def engines_of(folder: Path, script: Script, killed_in: dict[str, str]) -> tuple[dict[str, str], list[str]]:
    """By the function that it is in, the engine that judged the reversed command, and what was said."""
    script.mutated = lambda run: CHECKED if run.test == killed_in.get(function_of(run.mutant)) else {}
    write_project(folder, FUNCTIONS, IN_ORDER)
    progress = Quiet()
    path = run_campaign(request_for(folder, engine="auto", only=("*:reverse",)), progress)
    found = {outcome.mutant.split(":")[1]: outcome.engine for outcome in outcomes(path)}
    return found, [line for line in progress.lines if "in a fork" in line]


def function_of(mutant: Mutant | None) -> str:
    return mutant.site.span.function if mutant is not None else ""


def test_from_the_test_in_which_the_identity_ends_otherwise_no_fork_is_believed(
    tmp_path: Path, script: Script
) -> None:
    script.control = lambda run: CHECKED if run.is_fork and run.test == THIRD and is_identity(run) else None
    found, said = engines_of(tmp_path, script, {"second": SECOND})
    assert found == {"first": "replay", "second": "fork"}
    assert len(said) == 1
    assert f"ended wrongly in a fork in {THIRD}" in said[0]


def is_identity(run: Run) -> bool:
    return run.mutant is not None and run.mutant.operator == IDENTITY


def test_where_the_fatal_control_does_not_end_a_fork_no_fork_is_believed(
    tmp_path: Path, script: Script
) -> None:
    script.control = lambda run: {} if run.is_fork and not is_identity(run) else None
    found, said = engines_of(tmp_path, script, {})
    assert found == {"first": "replay", "second": "replay"}
    assert "results of forks from any test do not count" in said[0]


def test_what_forks_report_of_a_test_whose_own_control_ended_otherwise_is_left_to_replay(
    tmp_path: Path, script: Script
) -> None:
    script.test_control = lambda run: CHECKED if run.test == SECOND else None
    found, _ = engines_of(tmp_path, script, {"second": SECOND})
    assert found == {"first": "fork", "second": "replay"}


SUITE = ["a::one", "b::two", "c::three"]


def mutant_at(line: int) -> Mutant:
    site = Site(Span("m.py", line, 0, line, 9, "run"), "arm.move", 1, Role.PROGRAM)
    return Mutant(line, "robot", "skip", site, "robot:Arm.move", None, None, "", "")


def baseline_of(reached: dict[int, list[str]], early: set[int]) -> tuple[Baseline, list[Mutant]]:
    """Lines with the tests that reach them; later tests are quicker."""
    ends = {
        (0, test): TestEnd(test, "passed", wall=3.0 - number, operations=3 - number)
        for number, test in enumerate(SUITE)
    }
    baseline = Baseline(tests=[SUITE], ends=ends)
    mutants = {line: mutant_at(line) for line in reached}
    planned = [
        PlannedMutant(mutant, active=Activation.of_call(Place.of(mutant))) for mutant in mutants.values()
    ]
    baseline.add_planned({CALLS: Planned(planned)})
    baseline.early = {Place.of(mutants[line]) for line in early}
    for line, tests in reached.items():
        baseline.reach(0, Place.of(mutants[line]), None if line in early else tests)
    return baseline, [*mutants.values()]


def acting(baseline: Baseline, mutants: list[Mutant], *, forked: bool) -> list[tuple[str, int, str]]:
    found = controls_of(baseline, mutants, forked=forked)
    return sorted((control.name, control.place.site.span.line, control.subject) for control in found)


def test_without_imports_controls_act_where_the_quickest_test_is() -> None:
    made = baseline_of({1: ["a::one"], 2: ["b::two"], 3: ["a::one", "c::three"]}, set())
    assert acting(*made, forked=False) == [(FATAL, 3, "c"), (IDENTITY, 3, "c")]


def test_the_controls_of_forks_act_in_the_first_test_that_reaches_a_mutant() -> None:
    made = baseline_of({2: ["b::two"], 1: ["a::one"], 3: ["a::one", "c::three"]}, set())
    assert acting(*made, forked=True) == [(FATAL, 1, "a"), (IDENTITY, 1, "a")]


def test_beside_an_identity_of_the_imports_the_other_one_is_forked_as_late_as_possible() -> None:
    reached = {1: ["a::one"], 2: ["b::two"], 3: ["a::one", "c::three"], 4: []}
    made = baseline_of(reached, {4})
    assert acting(*made, forked=True) == [(FATAL, 2, "b"), (IDENTITY, 2, "b"), (IDENTITY, 4, IMPORT)]
    assert acting(*made, forked=False) == [(FATAL, 3, "c"), (IDENTITY, 3, "c")]


def test_a_kill_by_the_first_test_awaits_controls_if_the_mutant_was_forked_before_any_test() -> None:
    baseline, (early, late) = baseline_of({1: [], 2: ["a::one"]}, {1})
    controls = {control.mutant.id: control for control in controls_of(baseline, [early, late], forked=True)}
    trust = ForkTrust(cast("Campaign", SimpleNamespace(baseline=baseline, progress=Quiet())), controls)
    kills = {mutant.id: Outcome(mutant.id, 0, Verdict.KILLED, test="a::one") for mutant in (early, late)}
    assert trust.awaits(early, kills[early.id])
    assert not trust.awaits(late, kills[late.id])
