"""A second look at outcomes, some of which are not the same twice on purpose."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.engines.rerun import choose, unconfirmed
from mutabot.campaign.run import run_campaign
from mutabot.cli.app import main
from mutabot.errors import UnstableError
from mutabot.journal.journal import Journal
from mutabot.model import By, Outcome, Verdict
from mutabot.model.outcome_text import same_end
from mutabot.results.gate import decide
from mutabot.results.results import Results, read_results
from tests.campaign.project import CONFIGURATION, DEPENDENT, Quiet, outcomes, request_for, write_project
from tests.campaign.scripted import CHECKED, CRASHED, Script

MISSION = """
    def run(arm):
        arm.move_by(0.5)
        arm.move_by(-0.25)
        arm.position()
"""
TESTS = """
    import mission
    from robot import Arm

    def test_moves():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.25
"""
FLAKY, SOUND = "tests/test_mission.py::test_flaky", "tests/test_mission.py::test_sound"
ENGINES = pytest.mark.parametrize("engine", ["replay", "fork"])


def campaign(folder: Path, **changes: Any) -> tuple[Results, Quiet]:
    progress = Quiet()
    path = run_campaign(request_for(folder, **changes), progress)
    with Journal.open(path) as journal:
        return read_results(journal), progress


@ENGINES
def test_verify_agrees_on_a_deterministic_program(tmp_path: Path, script: Script, engine: str) -> None:
    script.kill("reverse")
    write_project(tmp_path, MISSION, TESTS)
    results, progress = campaign(tmp_path, engine=engine, verify=100, only=("*:reverse", "*:negate"))
    assert results.verification is not None
    assert results.verification.checked == results.done
    assert results.verification.disagreements == ()
    assert f"verify: {results.done} of {results.done} outcomes agree" in progress.lines
    assert decide(results, max_unstable=0.0).exit_code == 0


@ENGINES
def test_verify_finds_an_outcome_that_a_second_run_does_not_have(
    tmp_path: Path, script: Script, engine: str
) -> None:
    script.mutated = lambda run: CRASHED if run.before else {}
    write_project(tmp_path, MISSION, TESTS)
    results, _ = campaign(tmp_path, engine=engine, verify=100, only=("*move_by#1*:reverse",))
    assert results.verification is not None
    (wrong,) = results.verification.disagreements
    assert wrong.first == "survived"
    assert wrong.second == "killed by exception in tests/test_mission.py::test_moves: it went wrong"
    assert results.mutants[0].outcomes[0].verdict is Verdict.SURVIVED  # what was found first stays
    decision = decide(results)
    assert decision.exit_code == 4
    assert any(wrong.mutant in line for line in decision.lines)


def test_tests_that_pass_only_together_are_verified_together(tmp_path: Path, script: Script) -> None:
    script.control = lambda run: CRASHED if len(run.tests) == 1 and "finishes" in run.test else None
    script.mutated = lambda run: CRASHED if len(run.tests) == 1 and "finishes" in run.test else {}
    write_project(tmp_path, *DEPENDENT)
    results, _ = campaign(tmp_path, engine="replay", verify=100, only=("*:reverse", "*:negate"))
    assert results.verification is not None
    assert results.verification.checked == 2
    assert results.verification.disagreements == ()


def flaky_project(folder: Path, script: Script, limit: float) -> None:
    """One of its two tests passes only the first time."""
    tests = TESTS.replace("test_moves", "test_flaky") + TESTS[TESTS.index("    def") :].replace(
        "test_moves", "test_sound"
    )
    script.original = lambda run: CHECKED if run.test == FLAKY and run.before else {}
    configuration = f"{CONFIGURATION}    unstable_limit = {limit}\n"
    write_project(folder, MISSION, tests, configuration=configuration)


def test_flaky_tests_beyond_the_limit_stop_the_run_before_any_mutant(tmp_path: Path, script: Script) -> None:
    flaky_project(tmp_path, script, 0.4)
    with pytest.raises(
        UnstableError, match=r"1 of 2 tests cannot be relied on \(50%\)(.|\n)*test_flaky"
    ) as caught:
        campaign(tmp_path, engine="replay")
    assert caught.value.exit_code == 4
    assert outcomes(tmp_path / ".mutabot" / "journal.sqlite") == []


def test_flaky_tests_that_a_fork_parent_finds_fail_the_run_beyond_the_limit(
    tmp_path: Path, script: Script
) -> None:
    flaky_project(tmp_path, script, 0.4)
    results, progress = campaign(tmp_path, engine="fork")
    assert any("excluded as flaky" in line and "test_flaky" in line for line in progress.lines)
    decision = decide(results, max_unstable=0.4)
    assert decision.exit_code == 4
    assert "test_flaky in round 1" in decision.lines[0]


@ENGINES
def test_flaky_tests_within_the_limit_are_named_in_the_results(
    tmp_path: Path, script: Script, engine: str
) -> None:
    flaky_project(tmp_path, script, 0.5)
    results, _ = campaign(tmp_path, engine=engine)
    assert [line.partition(" in ")[0] for line in results.flaky.tests] == [
        "tests/test_mission.py::test_flaky"
    ]
    assert results.flaky.share == 0.5


def test_the_command_line_verifies_and_replays(
    tmp_path: Path, script: Script, capsys: pytest.CaptureFixture[str]
) -> None:
    script.mutated = lambda run: CRASHED if run.before else {}
    write_project(tmp_path, MISSION, TESTS)
    assert main(["-C", str(tmp_path), "run", "--only", "*move_by#1*:reverse", "--verify", "5"]) == 4
    out, err = capsys.readouterr()
    assert "Verified: 0 of 1 outcomes end the same in fresh processes" in out
    assert "mutant 1 (mission.py:run:arm.move_by#1:dx:reverse), round 1" in err
    script.mutated = lambda run: CRASHED
    assert main(["-C", str(tmp_path), "replay", "1", "--round", "1"]) == 4
    out, _ = capsys.readouterr()
    assert "Round 1: not as in the journal" in out
    assert "it went wrong" in out
    assert main(["-C", str(tmp_path), "replay", "1", "--json"]) == 4
    (row,) = json.loads(capsys.readouterr().out)["rounds"]
    assert (row["round"], row["agrees"]) == (1, False)
    assert (row["journal"]["verdict"], row["replay"]["verdict"]) == ("survived", "killed")
    script.mutated = lambda run: {}
    assert main(["-C", str(tmp_path), "replay", "1"]) == 0
    assert "Round 1: as in the journal" in capsys.readouterr().out
    assert main(["-C", str(tmp_path), "replay", "1", "--round", "2"]) == 2


def test_replay_finds_a_mutant_that_edits_elsewhere_have_moved(
    tmp_path: Path, script: Script, capsys: pytest.CaptureFixture[str]
) -> None:
    write_project(tmp_path, MISSION, TESTS)
    assert main(["-C", str(tmp_path), "run", "--only", "*:reverse"]) == 0
    program = tmp_path / "mission.py"
    program.write_text("# a new line\n" + program.read_text())
    assert main(["-C", str(tmp_path), "replay", "1"]) == 0
    program.write_text("def run(arm):\n    arm.x = 0.25\n    arm.position()\n")
    capsys.readouterr()
    assert main(["-C", str(tmp_path), "replay", "1"]) == 2
    assert "the program has changed" in capsys.readouterr().err


def ended(mutant: str, verdict: Verdict = Verdict.KILLED, **more: Any) -> Outcome:
    return Outcome(mutant, 0, verdict, **{"by": By.CHECK, "test": "t", "tests": 1, **more})


def test_the_choice_is_random_and_always_the_same() -> None:
    some = [ended(str(number)) for number in range(50)]
    chosen = choose(some, 10, seed=1)
    assert chosen == choose(reversed(some), 10, seed=1)
    assert len(set(chosen)) == 10
    assert chosen != choose(some, 10, seed=2)
    assert len(choose(some, 100, seed=1)) == 50


def test_outcomes_without_a_run_are_not_chosen() -> None:
    assert choose([Outcome("m", 0, Verdict.NOT_COVERED)], 5, seed=1) == []


@pytest.mark.parametrize(
    ("change", "same"),
    [
        ({}, True),
        ({"wall": 3.0, "engine": "fork"}, True),
        ({"message": "<Arm at 0x7f0000aaaaaa> in /tmp/pytest-of-me/pytest-7/x"}, True),
        ({"message": "<Leg at 0x7f0000aaaaaa> in /tmp/pytest-of-me/pytest-7/x"}, False),
        ({"by": By.EXCEPTION}, False),
        ({"test": "other"}, False),
        ({"verdict": Verdict.TIMEOUT}, False),
    ],
)
def test_two_ends_are_the_same_in_verdict_by_test_and_message(change: dict[str, Any], same: bool) -> None:
    message = "<Arm at 0x7f1234567890> in /tmp/pytest-of-me/pytest-3/x"
    first = ended("m", message=message)
    assert same_end(first, ended("m", **{"message": message, **change})) is same


def test_an_unconfirmed_outcome_says_both_ends() -> None:
    first = Outcome("m", 0, Verdict.SURVIVED, indistinguishable=True, distance=0.0)
    outcome = unconfirmed(first, ended("m", message="assert 1 == 2\nmore"))
    assert (outcome.verdict, outcome.by, outcome.test) == (Verdict.UNSTABLE, None, "t")
    assert outcome.message == "survived; run once more: killed by check in t: assert 1 == 2"
    assert outcome.indistinguishable is None
