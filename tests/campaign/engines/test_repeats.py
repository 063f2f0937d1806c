"""Kills that may be chance are run once more, and count no longer if they do not come out again."""

from __future__ import annotations

import re
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.engines import rerun
from mutabot.campaign.engines.rerun import Doubts
from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.journal.records import Repeated
from mutabot.model import By, Mutant, Outcome, Role, Site, Span, Verdict
from mutabot.model.events import TestEnd
from mutabot.model.mutant import Place
from mutabot.results.results import Results, read_results
from mutabot.results.statistics import false_kills
from tests.campaign.project import CONFIGURATION, Quiet, outcomes, request_for, write_project
from tests.campaign.scripted import CHECKED, End, Run, Script

MISSION = """
    def run(arm):
        arm.move_by(0.25)
        arm.move_by(-0.0625)
        arm.move_by(0.03125)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_flaky():
        arm = Arm()
        mission.run(arm)
        assert arm.x > 0
"""
FLAKY = "tests/test_mission.py::test_flaky"
#: the one that is noticed, or was once
FALSE = "mission.py:run:arm.move_by#2:dx:reverse"
ENGINES = pytest.mark.parametrize("engine", ["replay", "fork"])


def campaign(folder: Path, **changes: Any) -> tuple[Results, dict[str, Outcome], Quiet]:
    progress = Quiet()
    path = run_campaign(request_for(folder, **changes), progress)
    with Journal.open(path) as journal:
        found = read_results(journal)
    return found, {outcome.mutant: outcome for outcome in outcomes(path)}, progress


@ENGINES
def test_a_kill_in_doubt_that_does_not_come_out_again_is_unstable(
    tmp_path: Path, script: Script, engine: str
) -> None:
    script.mutated = lambda run: CHECKED if run.mutant.id == FALSE and not run.before else {}
    write_project(tmp_path, MISSION, TESTS)
    results, found, progress = campaign(tmp_path, engine=engine, repeats=True)
    assert {outcome.verdict for mutant, outcome in found.items() if mutant != FALSE} == {Verdict.SURVIVED}
    assert found[FALSE].verdict is Verdict.UNSTABLE
    message = found[FALSE].message or ""
    assert message.startswith(f"killed by check in {FLAKY}: assert ")
    assert message.endswith("; run once more: survived")
    assert "re-runs: 0 of 1 doubtful kills confirmed" in progress.lines
    assert results.repeats.doubted == Repeated(1, 1, 1)
    estimate = false_kills(results.repeats)
    assert estimate is not None
    assert (estimate.expected, estimate.low, estimate.high, estimate.known) == (0.0, 0, 0, 0)


def test_repeats_beyond_their_time_are_left_and_reported(
    tmp_path: Path, script: Script, monkeypatch: pytest.MonkeyPatch
) -> None:
    script.kill(FALSE)
    for name in ("SHARE", "MOST_SECONDS", "MOST_SHARE"):
        monkeypatch.setattr(rerun, name, 0.0)
    write_project(tmp_path, MISSION, TESTS)
    results, found, progress = campaign(tmp_path, engine="fork", repeats=True)
    assert found[FALSE].verdict is Verdict.KILLED
    assert any("1 not re-run, as re-runs may take 0 s" in line for line in progress.lines)
    assert (results.repeats.doubted, false_kills(results.repeats)) == (Repeated(1, 0, 0), None)


@pytest.mark.parametrize("is_ahead", [False, True], ids=["one by one", "asked for ahead"])
def test_one_kill_is_repeated_even_if_that_takes_longer_than_its_share(
    tmp_path: Path, script: Script, monkeypatch: pytest.MonkeyPatch, is_ahead: bool
) -> None:
    mission = "\n\n".join(f"def {name}(arm):\n    arm.move_by(0.2)" for name in ("one", "two", "three"))
    tests = "\n".join(f"def test_{name}():\n    mission.{name}(Arm())\n" for name in ("one", "two", "three"))

    def mutated(run: Run) -> End:
        is_own = run.mutant is not None and f":{run.test.rpartition('_')[2]}:" in run.mutant.id
        return CHECKED if is_own and run.mutant.id.endswith("reverse") else {}

    script.mutated = mutated
    monkeypatch.setattr(rerun, "SHARE", 10.0)
    monkeypatch.setattr(Doubts, "cost", lambda self, key: 1e6)
    if is_ahead:  # as executors ask for more than they run
        replay = rerun.replay
        monkeypatch.setattr(rerun, "replay", lambda campaign, runs: replay(campaign, list(runs)))
    write_project(tmp_path, mission, f"import mission\nfrom robot import Arm\n{tests}")
    _, _, progress = campaign(tmp_path, repeats=True)
    (told,) = [line for line in progress.lines if line.startswith("re-runs:")]
    assert told.startswith("re-runs: 1 of 1 doubtful kills confirmed; 2 not re-run")


def test_more_kills_are_repeated_once_one_does_not_come_out_again(
    tmp_path: Path, script: Script, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ("one", "two", "three", "four", "five", "six")
    mission = "\n\n".join(f"def {name}(arm):\n    arm.move_by(0.2)" for name in names)
    tests = "\n".join(f"def test_{name}():\n    mission.{name}(Arm())\n" for name in names)
    lines: dict[bool, str] = {}
    monkeypatch.setattr(rerun, "SHARE", 4.0)  # by its clock a campaign takes a quarter of a second
    for comes_again in (True, False):

        def mutated(run: Run, comes_again: bool = comes_again) -> End:
            is_own = run.mutant is not None and f":{run.test.rpartition('_')[2]}:" in run.mutant.id
            is_noticed = is_own and run.mutant.id.endswith("reverse") and (comes_again or not run.before)
            return CHECKED if is_noticed else {}

        script.mutated = mutated
        clock = count(0.0, 0.25)
        monkeypatch.setattr(Request, "clock", lambda _, clock=clock: next(clock))
        text = f"import mission\nfrom robot import Arm\n{tests}"
        folder = write_project(tmp_path / str(comes_again), mission, text)
        _, _, progress = campaign(folder, repeats=True)
        lines[comes_again] = next(line for line in progress.lines if line.startswith("re-runs:"))
    told = r"re-runs: ([1-9]) of \1 doubtful kills confirmed; (\d) not re-run, as re-runs may take \d+ s"
    left = re.fullmatch(told, lines[True])
    assert left is not None
    assert int(left[1]) + int(left[2]) == len(names)
    assert lines[False] == "re-runs: 0 of 6 doubtful kills confirmed"


def test_a_kill_that_came_out_again_is_not_repeated_by_the_next_campaign(
    tmp_path: Path, script: Script
) -> None:
    script.kill(FALSE)
    write_project(tmp_path, MISSION, TESTS)
    _, found, progress = campaign(tmp_path, repeats=True)
    assert (found[FALSE].verdict, found[FALSE].repeats) == (Verdict.KILLED, 1)
    assert "re-runs: 1 of 1 doubtful kills confirmed" in progress.lines
    results, found, progress = campaign(tmp_path, repeats=True)
    assert (found[FALSE].verdict, found[FALSE].repeats) == (Verdict.KILLED, 1)
    assert not [line for line in progress.lines if line.startswith("re-runs:")]
    assert results.repeats.certain == 1


def test_more_runs_of_the_baseline_find_a_test_that_fails_at_random(tmp_path: Path, script: Script) -> None:
    script.original = lambda run: CHECKED if run.test == FLAKY and run.before == 2 else {}
    more = TESTS[TESTS.index("    def") :].replace("test_flaky", "test_moves")
    write_project(tmp_path, MISSION, TESTS + more, configuration=CONFIGURATION + "    unstable_limit = 0.5\n")
    _, _, progress = campaign(tmp_path, only=("*:reverse",), baseline=3)
    assert any(f"excluded in round 1: {FLAKY}" in line for line in progress.lines)


# What is in doubt

SITE = Site(Span("m.py", 1, 0, 1, 9, "run"), "arm.move", 1, Role.PROGRAM)
PLACE = Place(SITE, "robot:Arm.move")


def doubts(
    kills: dict[str, list[tuple[int, int]]], mutants: int, rounds: int = 1, clock: float | None = None
) -> Doubts:
    """Mutants of which each test kills some, given as (mutant, round); all tests judge all of them."""
    baseline = Baseline(tests=[list(kills)] * rounds)
    for round in range(rounds):
        baseline.reaching[round, PLACE] = list(kills)
        for test in kills:
            baseline.ends[round, test] = TestEnd(test, "passed", wall=1.0, simulated=clock)
    made = [Mutant(n, "robot", "skip", SITE, PLACE.operation, None, None, str(n), "") for n in range(mutants)]
    by = {pair: test for test, pairs in kills.items() for pair in pairs}
    found = {}
    for number, mutant in enumerate(made):
        for round in range(rounds):
            test = by.get((number, round))
            verdict = Verdict.SURVIVED if test is None else Verdict.KILLED
            found[mutant.id, round] = Outcome(
                mutant.id, round, verdict, By.CHECK if test else None, test, tests=len(kills)
            )
    return Doubts(baseline, {mutant.id: mutant for mutant in made}, found)


def numbers(found: Doubts) -> list[tuple[int, int]]:
    by_id = {mutant.id: number for number, mutant in enumerate(found.mutants.values())}
    return sorted((by_id[mutant], round) for mutant, round in found.in_doubt())


def test_few_kills_of_a_test_without_a_clock_are_in_doubt() -> None:
    assert numbers(doubts({"t": [(3, 0), (7, 0)]}, 10)) == [(3, 0), (7, 0)]
    assert numbers(doubts({"t": [(n, 0) for n in range(3)]}, 10)) == []
    assert numbers(doubts({"t": [(n, 0) for n in range(9)]}, 99)) == [(n, 0) for n in range(9)]


def test_kills_in_simulated_time_are_in_doubt_only_where_equal_runs_were_not_equal() -> None:
    found = doubts({"t": [(3, 0)]}, 10, clock=2.0)
    assert numbers(found) == []
    assert found.is_certain(next(iter(found.kills())))
    found.baseline.inexact.add((0, "t"))
    again = Doubts(found.baseline, found.mutants, found.outcomes)
    assert numbers(again) == [(3, 0)]
    assert not again.is_certain(next(iter(again.kills())))


def test_a_mutant_that_a_test_kills_in_several_rounds_is_not_in_doubt() -> None:
    kills = [(3, 0), (3, 1), (7, 1)]
    assert numbers(doubts({"t": kills}, 10, rounds=2)) == [(7, 1)]


def test_all_kills_of_a_test_that_was_seen_to_be_unreliable_are_in_doubt() -> None:
    kills = [(n, 0) for n in range(8)]
    found = doubts({"t": kills, "u": [(9, 0), (8, 0)]}, 20)
    assert numbers(found) == [(8, 0), (9, 0)]
    found.unreliable.add("t")
    assert numbers(found) == [(n, 0) for n in range(10)]
    found.baseline.unstable[1, "v"] = "fails on the unmutated program with seed 3"
    assert Doubts(found.baseline, found.mutants, found.outcomes).unreliable == set()


def test_the_cheapest_repeats_come_first() -> None:
    found = doubts({"t": [(1, 0)], "u": [(0, 0)]}, 10)
    assert [found.cost(key) for key in sorted(found.kills())] == [2.0, 1.0]
