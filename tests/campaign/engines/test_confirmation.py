"""Mutants that are run without tests that do not reach them, and which of them the whole suite confirms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign import preparation
from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.model import Outcome, Verdict
from tests.campaign.project import Quiet, request_for, write_project
from tests.campaign.scripted import CHECKED, REFUSED, Run, Script

MUTANTS, OTHERS = 20, 5
MISSION = f"""
    def go(arm):
{"".join(f"        arm.move_by(0.{number:02})" + chr(10) for number in range(1, MUTANTS + 1))}
"""
OTHER = "".join(f"    def test_other_{number}():\n        pass\n\n" for number in range(OTHERS))
TESTS = f"""
    import mission
    from robot import Arm

    def test_before():
        pass

    def test_goes():
        mission.go(Arm())

{OTHER}
    def test_goes_again():
        mission.go(Arm())

    def test_after():
        pass
"""
#: the one that reaches the mutants first, and one that is left out
GOES, OTHER_TEST = "tests/test_mission.py::test_goes", "tests/test_mission.py::test_other_3"
AGAIN = "tests/test_mission.py::test_goes_again"
ENGINES = pytest.mark.parametrize("engine", ["fork", "replay"])


@pytest.fixture
def script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Script:
    """All survive; tests that do not reach them take a minute each."""
    write_project(tmp_path, MISSION, TESTS)
    script = Script(original=lambda run: {"wall": 0.01 if "goes" in run.test else 60.0})
    monkeypatch.setattr(preparation, "open_executor", script.opened)
    return script


def campaign(folder: Path, **changes: Any) -> tuple[list[Outcome], list[str]]:
    quiet = Quiet()
    request = request_for(folder, **{"only": ("skip",), "engine": "fork", **changes})
    with Journal.open(run_campaign(request, quiet)) as journal:
        return journal.outcomes(), quiet.lines


def left_out(script: Script) -> set[str]:
    """The tests that some mutant was run without."""
    return {
        test for task in script.tasks for mutant in task.job.reaching for test in task.job.left_out(mutant)
    }


def ends(outcomes: list[Outcome]) -> set[tuple[Verdict, str | None, bool | None]]:
    return {(outcome.verdict, outcome.test, outcome.confirmed) for outcome in outcomes}


@ENGINES
def test_of_the_survivors_a_sample_is_confirmed(tmp_path: Path, script: Script, engine: str) -> None:
    outcomes, lines = campaign(tmp_path, engine=engine)
    assert {outcome.verdict for outcome in outcomes} == {Verdict.SURVIVED}
    confirmed = [outcome for outcome in outcomes if outcome.confirmed]
    assert 0 < len(confirmed) < MUTANTS / 2
    assert sum(outcome.confirmed is False for outcome in outcomes) == MUTANTS - len(confirmed)
    assert {outcome.tests for outcome in confirmed} == {OTHERS + 4}
    # what comes before the first hit is not left out: a fork has it from its parent
    assert OTHER_TEST in left_out(script)
    assert not {GOES, AGAIN, "tests/test_mission.py::test_before"} & left_out(script)
    told = (
        f"{MUTANTS} mutants were let through without tests that do not reach them; {len(confirmed)} of these"
    )
    assert any(told in line for line in lines)


def test_the_sample_depends_on_the_seed(tmp_path: Path, script: Script) -> None:
    drawn = []
    for seed in (1, 1, 2):
        outcomes, _ = campaign(tmp_path, seed=seed, fresh=True, journal=f"{len(drawn)}.sqlite")
        drawn.append({outcome.mutant for outcome in outcomes if outcome.confirmed})
    assert drawn[0] == drawn[1] != drawn[2]


@ENGINES
def test_one_that_the_whole_suite_notices_makes_it_run_for_all(
    tmp_path: Path, script: Script, engine: str
) -> None:
    script.mutated = lambda run: CHECKED if run.test == OTHER_TEST else {}
    outcomes, lines = campaign(tmp_path, engine=engine)
    assert ends(outcomes) == {(Verdict.KILLED, OTHER_TEST, True)}
    assert len(outcomes) == MUTANTS
    assert any("so all are run with it" in line for line in lines)


@ENGINES
@pytest.mark.parametrize("end", [CHECKED, REFUSED, {**CHECKED, "failure": "it went NaN"}])
def test_an_end_that_comes_from_leaving_tests_out_does_not_count(
    tmp_path: Path, script: Script, engine: str, end: dict[str, Any]
) -> None:
    script.mutated = lambda run: end if run.test == AGAIN and run.is_short else {}
    outcomes, _ = campaign(tmp_path, engine=engine)
    assert {(outcome.verdict, outcome.confirmed, outcome.tests) for outcome in outcomes} == {
        (Verdict.SURVIVED, None, OTHERS + 4)
    }


@ENGINES
def test_a_kill_before_anything_is_left_out_counts(tmp_path: Path, script: Script, engine: str) -> None:
    script.mutated = lambda run: CHECKED if run.test == GOES and run.is_short else {}
    outcomes, _ = campaign(tmp_path, engine=engine)
    assert ends(outcomes) == {(Verdict.KILLED, GOES, None)}


def test_a_kill_after_that_is_reported_as_the_whole_suite_ends(tmp_path: Path, script: Script) -> None:
    def mutated(run: Run) -> Any:
        return CHECKED if run.test == AGAIN or (run.test == OTHER_TEST and not run.is_short) else {}

    script.mutated = mutated
    outcomes, _ = campaign(tmp_path)
    assert ends(outcomes) == {(Verdict.KILLED, OTHER_TEST, None)}


def test_of_what_is_refused_at_first_a_sample_is_confirmed_too(tmp_path: Path, script: Script) -> None:
    script.mutated = lambda run: REFUSED if run.test == GOES else {}
    outcomes, _ = campaign(tmp_path)
    assert {outcome.verdict for outcome in outcomes} == {Verdict.REFUSED}
    assert {outcome.confirmed for outcome in outcomes} == {True, False}


def test_an_error_while_it_is_confirmed_says_nothing_of_the_others(tmp_path: Path, script: Script) -> None:
    failed = {**CHECKED, "failure": "it went NaN"}
    script.mutated = lambda run: {} if run.is_short or run.test != OTHER_TEST else failed
    outcomes, _ = campaign(tmp_path)
    assert {outcome.verdict for outcome in outcomes if outcome.confirmed} == {Verdict.ERROR}
    assert sum(outcome.verdict is Verdict.SURVIVED for outcome in outcomes) > MUTANTS / 2


def test_a_campaign_that_goes_on_keeps_to_what_was_decided(tmp_path: Path, script: Script) -> None:
    def stop(run: Run) -> Any:
        if "#7:" in (run.mutant.id if run.mutant is not None else ""):
            raise KeyboardInterrupt
        return {}

    script.mutated = stop
    with pytest.raises(KeyboardInterrupt):
        campaign(tmp_path)
    script.mutated, script.original = lambda run: {}, lambda run: {}
    script.tasks.clear()
    outcomes, _ = campaign(tmp_path)
    assert left_out(script)
    assert {outcome.confirmed for outcome in outcomes} <= {True, False}
    assert len(outcomes) == MUTANTS


def test_another_run_confirms_more(tmp_path: Path, script: Script) -> None:
    first, _ = campaign(tmp_path)
    second, _ = campaign(tmp_path)
    confirmed = [{outcome.mutant for outcome in some if outcome.confirmed} for some in (first, second)]
    assert confirmed[0] < confirmed[1]


def test_nothing_is_left_out_of_a_small_suite(tmp_path: Path, script: Script) -> None:
    script.original = lambda run: {"wall": 0.01 if "goes" in run.test else 0.2}
    outcomes, _ = campaign(tmp_path)
    assert not left_out(script)
    assert {outcome.confirmed for outcome in outcomes} == {None}


def test_a_search_for_thresholds_goes_by_the_whole_suite(tmp_path: Path, script: Script) -> None:
    script.mutated = lambda run: CHECKED if run.test == OTHER_TEST else {}
    outcomes, _ = campaign(tmp_path, only=("skip", "offset"), families=("robot", "graded"))
    graded = {outcome.mutant for outcome in outcomes if "offset" in outcome.mutant}
    assert graded
    assert left_out(script)  # of the others
    assert not graded & {mutant for task in script.tasks for mutant in task.job.reaching}
    assert ends([outcome for outcome in outcomes if outcome.mutant in graded]) == {
        (Verdict.KILLED, OTHER_TEST, None)
    }


def test_limited_time_confirms_as_well(tmp_path: Path, script: Script) -> None:
    outcomes, _ = campaign(tmp_path, budget=100_000.0)
    assert {outcome.confirmed for outcome in outcomes} == {True, False}
