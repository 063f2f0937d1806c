"""What stops a campaign before any mutant runs, and what it then says."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import check
from mutabot.campaign.run import run_campaign
from mutabot.errors import (
    BaselineError,
    ConfigurationError,
    ControlError,
    MutabotError,
    NothingToDoError,
    SelectionError,
    UnknownNameError,
)
from mutabot.model import Verdict
from tests.campaign.project import (
    CONFIGURATION,
    ROBOT,
    VOCABULARY,
    Quiet,
    outcomes,
    request_for,
    run,
    write_project,
)
from tests.campaign.scripted import CHECKED, Script

MISSION = """
    def run(arm):
        arm.move_by(0.5)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_moves():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.5
"""


def stopped(folder: Path, error: type[MutabotError], words: str) -> MutabotError:
    with pytest.raises(error, match=words) as caught:
        run(folder)
    return caught.value


def test_a_test_that_fails_on_the_original_stops_the_campaign(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS.replace("== 0.5", "== 0.7"))
    error = stopped(tmp_path, BaselineError, "1 test fails on the unmutated program in round 1")
    assert error.exit_code == 3
    assert "test_moves" in str(error)


def test_no_tests_stop_the_campaign(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, "import mission\n")
    assert stopped(tmp_path, NothingToDoError, "finds no tests").exit_code == 3


def test_tests_that_all_skip_stop_the_campaign(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, "import pytest\n\ndef test_it():\n    pytest.skip('not here')\n")
    assert stopped(tmp_path, NothingToDoError, "1 skipped").exit_code == 3


def test_tests_that_cannot_be_collected_stop_the_campaign(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, "import no_such_module\n")
    assert "no_such_module" in str(stopped(tmp_path, BaselineError, "cannot be collected"))


def test_no_mutants_stop_the_campaign(tmp_path: Path) -> None:
    write_project(tmp_path, "def run(arm):\n    arm.x = 0.5\n", TESTS)
    assert stopped(tmp_path, NothingToDoError, "no test reaches a call").exit_code == 3


@pytest.mark.parametrize(
    ("clock", "words"),
    [
        ('{ tick = "robot:Arm.move_by" }', "clock · time: what robot:Arm.move_by returns gives None"),
        ('{ tick = "robot:Arm.move_by", time = "self.y" }', "clock · time: self.y: Arm has no .y"),
    ],
)
def test_a_clock_that_gives_no_number_stops_the_campaign_and_names_the_key(
    tmp_path: Path, clock: str, words: str
) -> None:
    write_project(tmp_path, MISSION, TESTS, vocabulary=f"    clock = {clock}\n{VOCABULARY}")
    error = stopped(tmp_path, ConfigurationError, words)
    assert error.exit_code == 2
    assert str(error).startswith("robot.toml:1 · clock")


def test_check_reports_a_clock_that_never_ticks(tmp_path: Path) -> None:
    write_project(
        tmp_path, MISSION, TESTS, vocabulary=f'    clock = {{ tick = "robot:Arm.position" }}\n{VOCABULARY}'
    )
    told, words = Quiet(), "clock: no test calls robot:Arm.position, so there is no simulated time"
    assert f"unused    {words}" in check(request_for(tmp_path), told).lines
    assert words not in told.lines  # it is told once


@pytest.mark.parametrize(
    ("ending", "words"),
    [
        ("os._exit(0)", "exit code 0"),
        pytest.param("os.kill(os.getpid(), 9)", "signal 9", marks=pytest.mark.whole),
        pytest.param("bytearray(10**11)", "memory", marks=pytest.mark.whole),
    ],
)
def test_an_original_that_does_not_live_to_the_end_stops_the_campaign(
    tmp_path: Path, ending: str, words: str
) -> None:
    write_project(tmp_path, f"import os\n\ndef run(arm):\n    arm.move_by(0.5)\n    {ending}\n", TESTS)
    stopped(tmp_path, BaselineError, words)


def test_a_callable_that_does_not_exist_is_named_with_the_nearest(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS, vocabulary=VOCABULARY.replace("Arm.move_by", "Arm.moveby"))
    error = stopped(tmp_path, UnknownNameError, "move_by")
    assert "robot.toml" in str(error)
    assert error.exit_code == 2


def test_an_argument_that_does_not_exist_is_named_with_the_nearest(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS, vocabulary=VOCABULARY.replace("arguments.dx", "arguments.dxx"))
    assert "'dx'" in str(stopped(tmp_path, UnknownNameError, "dxx"))


def test_a_result_path_that_does_not_fit_what_was_recorded_is_an_error(tmp_path: Path) -> None:
    wrong = VOCABULARY.replace("result = {", 'result.".y" = {')
    mission = "def run(arm):\n    arm.move_by(0.5)\n    arm.position()\n"
    write_project(tmp_path, mission, TESTS, vocabulary=wrong)
    assert stopped(tmp_path, ConfigurationError, "no .y").exit_code == 2


def test_a_flaky_test_is_set_aside_and_named(tmp_path: Path, script: Script) -> None:
    script.original = lambda run: CHECKED if "flaky" in run.test and run.before else {}
    script.mutated = lambda run: CHECKED
    tests = TESTS + "\n    def test_flaky():\n        mission.run(Arm())\n"
    write_project(tmp_path, MISSION, tests)
    progress = Quiet()
    path = run_campaign(request_for(tmp_path), progress)
    assert any("flaky" in line and "test_flaky" in line for line in progress.lines)
    assert all("flaky" not in (outcome.test or "") for outcome in outcomes(path))


def test_a_selection_that_fits_nothing_names_the_nearest(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS)
    with pytest.raises(SelectionError, match="reverse"):
        run(tmp_path, only=("revers",))


def test_check_reports_what_the_vocabulary_names_and_no_test_reaches(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS)
    report = check(request_for(tmp_path), Quiet())
    assert report.data["unused"] == ["robot:Arm.position"]
    assert report.data["controls"] == 2
    assert any("unused" in line for line in report.lines)


def test_a_test_that_cannot_fail_fails_the_fatal_control(tmp_path: Path, script: Script) -> None:
    script.control = lambda run: {"acted": int(run.mutant is not None and run.mutant.operator == "fatal")}
    write_project(tmp_path, MISSION, TESTS)
    error = stopped(tmp_path, ControlError, "fatal control")
    assert error.exit_code == 4


def test_a_mutant_that_no_test_reaches_in_a_round_is_not_covered_there(tmp_path: Path) -> None:
    mission = (
        "def run(arm, left):\n    if left:\n        arm.move_by(0.5)\n    else:\n        arm.move_by(0.25)\n"
    )
    tests = """
        import mission
        from robot import Arm

        def test_moves(mutabot_seed):
            arm = Arm()
            mission.run(arm, mutabot_seed % 2 == 0)
            assert arm.x > 0
    """
    configuration = CONFIGURATION + "    rounds = 6\n"
    write_project(tmp_path, mission, tests, configuration=configuration)
    path = run_campaign(request_for(tmp_path, only=("reverse",)), Quiet())
    verdicts = {
        (outcome.mutant.split("#")[1][0], outcome.round): outcome.verdict for outcome in outcomes(path)
    }
    assert len(verdicts) == 12
    for round in range(6):
        assert {verdicts["1", round], verdicts["2", round]} == {Verdict.KILLED, Verdict.NOT_COVERED}


def test_the_robots_state_is_its_own_in_every_process(tmp_path: Path) -> None:
    """A mutant that would poison module state must not touch any other mutant's run."""
    robot = ROBOT + "\n    TOTAL = []\n"
    mission = "import robot\n\ndef run(arm):\n    arm.move_by(0.5)\n    robot.TOTAL.append(arm.x)\n"
    tests = TESTS.replace("assert arm.x == 0.5", "assert sum(__import__('robot').TOTAL) == 0.5")
    write_project(tmp_path, mission, tests, robot=robot)
    found = run(tmp_path)
    assert {outcome.verdict for outcome in found.values()} == {Verdict.KILLED}


def test_a_plain_function_that_returns_a_coroutine_is_refused(tmp_path: Path) -> None:
    """Nothing has happened when it returns, so skipping or repeating it would mean something else."""
    robot = (
        ROBOT
        + """
    async def later():
        pass

    def start():
        return later()
    """
    )
    mission = "import asyncio, robot\n\ndef run(arm):\n    asyncio.run(robot.start())\n    arm.move_by(0.5)\n"
    vocabulary = VOCABULARY + '\n    [[operation]]\n    call = "robot:start"\n'
    write_project(tmp_path, mission, TESTS, robot=robot, vocabulary=vocabulary)
    stopped(tmp_path, ConfigurationError, "returns a coroutine but is not a coroutine function")
