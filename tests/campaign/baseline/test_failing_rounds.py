"""A test that fails on the original in one round is set aside there, and plain pytest fails alike."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.errors import BaselineError, UnstableError
from mutabot.journal.journal import Journal
from mutabot.model import Outcome, Verdict
from mutabot.model.call import derive
from mutabot.runtime.pytest_plugin import PlainRound
from tests.campaign.project import CONFIGURATION, REPLAY, Quiet, request_for, write_project
from tests.campaign.scripted import CHECKED, Script

MISSION = """
    def run(arm):
        arm.move_by(0.5)
"""
#: the first test fails in the rounds whose seeds make it so, and is the only one that checks anything
TESTS = """
    import random

    import mission
    import pytest
    from robot import Arm

    @pytest.fixture(scope="module")
    def shared():
        return random.random()

    def test_checks(mutabot_seed, shared):
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.5
        drawn = (mutabot_seed, random.random(), shared)
        assert mutabot_seed % 7 != 3, f"drew {drawn}"

    def test_runs():
        mission.run(Arm())
"""
CHECKS = "tests/test_mission.py::test_checks"
ENGINES = pytest.mark.parametrize("engine", ["fork", REPLAY])


def failing_rounds(seed: int, rounds: int) -> list[int]:
    return [round for round in range(rounds) if derive(seed, round, CHECKS) % 7 == 3]


def seed_with_one_failing_round(rounds: int) -> tuple[int, int]:
    seed = next(seed for seed in range(2, 1000) if len(failing_rounds(seed, rounds)) == 1)
    return seed, failing_rounds(seed, rounds)[0]


def campaign(folder: Path, **changes: object) -> tuple[dict[int, Outcome], Quiet]:
    """The outcomes of the one mutant that the project has of this operator."""
    progress = Quiet()
    with Journal.open(run_campaign(request_for(folder, only=("*:reverse",), **changes), progress)) as journal:
        return {outcome.round: outcome for outcome in journal.outcomes()}, progress


def plain_pytest(folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {key: value for key, value in os.environ.items() if not key.startswith("MUTABOT_")}
    return subprocess.run(
        [sys.executable, "-B", "-m", "pytest", "-o", "pythonpath=.", "-p", "no:cacheprovider", CHECKS],
        cwd=folder,
        env=environment | variables,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.usefixtures("plugins")
@ENGINES
@pytest.mark.whole
def test_a_test_that_fails_in_one_round_is_set_aside_there_and_plain_pytest_fails_alike(
    tmp_path: Path, engine: str
) -> None:
    seed, bad = seed_with_one_failing_round(2)
    write_project(tmp_path, MISSION, TESTS, configuration=CONFIGURATION + "    unstable_limit = 0.5\n")
    found, progress = campaign(tmp_path, engine=engine, rounds=2, seed=seed)
    (line,) = [line for line in progress.lines if line.startswith("excluded")]
    assert line.startswith(
        f"excluded in round {bad + 1}: {CHECKS} (fails on the unmutated program with seed "
    )
    assert f"seed {derive(seed, bad, CHECKS)}: drew (" in line
    command = f"MUTABOT_ROUND={bad + 1} MUTABOT_CAMPAIGN_SEED={seed} pytest -o pythonpath=. {CHECKS}"
    assert f"repeat it by {command})" in line
    # where it is set aside, nothing is claimed: the test that is left checks nothing
    others = {round: outcome.verdict for round, outcome in found.items() if round != bad}
    assert others == dict.fromkeys(set(range(2)) - {bad}, Verdict.KILLED)
    assert found[bad].verdict is Verdict.UNSTABLE
    assert (found[bad].message or "").startswith("all reliable tests passed; tests/")
    if engine == "fork":
        check_with_plain_pytest(tmp_path, seed, bad, line)


def check_with_plain_pytest(folder: Path, seed: int, bad: int, line: str) -> None:
    """It draws what the campaign says that the failing test drew."""
    drawn = re.search(r"drew \(.*?\)", line)
    assert drawn is not None
    variables = {"MUTABOT_CAMPAIGN_SEED": str(seed)}
    again = plain_pytest(folder, MUTABOT_ROUND=str(bad + 1), **variables)
    assert (again.returncode, drawn[0] in again.stdout) == (1, True)
    other = (bad + 1) % 2 + 1
    assert plain_pytest(folder, MUTABOT_ROUND=str(other), **variables).returncode == 0


def failing(script: Script, round: int) -> None:
    """Let the first test fail on the original in a round, and notice every mutant."""
    script.original = lambda run: CHECKED if run.test == CHECKS and run.round == round else {}
    script.mutated = lambda run: CHECKED if run.test == CHECKS else {}


def test_more_failing_rounds_than_the_limit_allows_end_the_run(tmp_path: Path, script: Script) -> None:
    failing(script, 1)
    write_project(tmp_path, MISSION, TESTS)
    with pytest.raises(UnstableError, match=r"1 of 4 tests .*25%.*\n.*test_checks in round 2: fails"):
        campaign(tmp_path, rounds=2)


@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_a_test_that_fails_in_all_rounds_is_an_error(tmp_path: Path, script: Script, engine: str) -> None:
    script.original = lambda run: CHECKED if run.test == CHECKS else {}
    write_project(tmp_path, MISSION, TESTS)
    with pytest.raises(
        BaselineError, match="1 test fails on the unmutated program in all 2 rounds"
    ) as caught:
        campaign(tmp_path, engine=engine, rounds=2)
    assert f"repeat by MUTABOT_ROUND=1 pytest -o pythonpath=. {CHECKS}" in str(caught.value)
    assert f"pytest_args = ['--deselect', '{CHECKS}']" in str(caught.value)


def test_a_test_that_fails_by_chance_in_the_only_round_is_flaky(tmp_path: Path, script: Script) -> None:
    """With one run per round it would look as if it always failed."""
    flaky = "tests/test_other.py::test_flaky"
    script.original = lambda run: CHECKED if run.test == flaky and not run.before else {}
    script.mutated = lambda run: CHECKED
    more = {"tests/test_other.py": "def test_flaky():\n    pass\n"}
    write_project(
        tmp_path, MISSION, TESTS, configuration=CONFIGURATION + "    unstable_limit = 0.5\n", more=more
    )
    found, progress = campaign(tmp_path, engine="fork", rounds=1)
    assert found[0].verdict is Verdict.KILLED
    assert (
        "excluded in round 1: tests/test_other.py::test_flaky (failed and passed in equal runs)"
        in progress.lines
    )


@pytest.mark.parametrize("rounds", [1, 2])
def test_what_fails_in_copies_of_one_process_alone_is_run_in_fresh_ones(
    tmp_path: Path, script: Script, rounds: int
) -> None:
    """Such as a test that compares its process with the one that imported it."""
    script.original = lambda run: CHECKED if script.tasks[-1].may_share and run.test == CHECKS else {}
    script.mutated = lambda run: CHECKED
    write_project(tmp_path, MISSION, TESTS)
    found, progress = campaign(tmp_path, engine="auto", rounds=rounds)
    assert {outcome.verdict for outcome in found.values()} == {Verdict.KILLED}
    assert sum("copies of a process that has imported" in line for line in progress.lines) == 1
    assert not any(task.may_share for task in script.tasks if task.is_fork_parent)


def test_a_site_that_only_a_failing_test_reaches_is_not_called_uncovered(
    tmp_path: Path, script: Script
) -> None:
    failing(script, 1)
    tests = TESTS.partition("    def test_runs")[0] + "    def test_nothing():\n        pass\n"
    write_project(tmp_path, MISSION, tests, configuration=CONFIGURATION + "    unstable_limit = 0.5\n")
    found, _ = campaign(tmp_path, rounds=2)
    assert found[1].verdict is Verdict.UNSTABLE
    assert f"{CHECKS} might have failed: it is excluded in this round" in (found[1].message or "")


@pytest.mark.parametrize(
    ("variables", "words"),
    [
        ({"MUTABOT_ROUND": "three"}, "MUTABOT_ROUND is 'three'; it takes a whole number from 1 on"),
        ({"MUTABOT_ROUND": "0"}, "MUTABOT_ROUND is '0'"),
        ({"MUTABOT_ROUND": "1", "MUTABOT_CAMPAIGN_SEED": "-1"}, "MUTABOT_CAMPAIGN_SEED is '-1'"),
        ({"MUTABOT_ROUND": "1", "MUTABOT_SEED": "5"}, "set one of the two"),
    ],
)
def test_a_round_that_makes_no_sense_is_an_error_of_usage(
    monkeypatch: pytest.MonkeyPatch, variables: dict[str, str], words: str
) -> None:
    for variable, value in variables.items():
        monkeypatch.setenv(variable, value)
    with pytest.raises(pytest.UsageError, match=words):
        PlainRound.from_environment()


@pytest.mark.usefixtures("plugins")
def test_pytest_reports_an_error_of_usage_without_a_traceback(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS)
    done = plain_pytest(tmp_path, MUTABOT_ROUND="three")
    assert done.returncode == 4
    assert "MUTABOT_ROUND is 'three'" in done.stderr
    assert "Traceback" not in done.stderr
