"""Every verdict from a real run: each function of the program reacts in its own way to a wrong reading."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import By, Outcome, Verdict
from tests.campaign.project import REPLAY, ROBOT, fingerprint, run, write_project

MISSION = """
    import os
    import signal
    import time

    import robot

    def noticed_by_the_test(arm):
        return arm.position()

    def noticed_by_the_test_in_a_helper(arm):
        return arm.position()

    def crashes(arm):
        return [1, 2][0 if arm.position() > 0 else 5]

    def asserts_itself(arm):
        x = arm.position()
        assert x > 0
        return x

    def breaks_a_monitor(arm):
        if arm.position() < 0:
            try:
                raise robot.Broken("never below zero")
            finally:
                pass
        return 1

    def nobody_cares(arm):
        str(arm.position())
        return 1

    def is_refused(arm):
        arm.move_by(0.75)
        return arm.x

    def handles_the_refusal(arm):
        try:
            arm.move_by(0.75)
        except robot.Refused:
            return None
        return arm.x

    def handles_the_refusal_unnoticed(arm):
        try:
            arm.move_by(0.75)
        except robot.Refused:
            pass
        return 1

    def wraps_the_refusal(arm):
        try:
            arm.move_by(0.75)
        except robot.Refused as error:
            raise RuntimeError("mission failed") from error

    def loops_forever(arm):
        while arm.position() < 0:
            pass

    def hangs(arm):
        if arm.position() < 0:
            while True:
                time.sleep(60)

    def leaves_the_process(arm):
        if arm.position() < 0:
            os._exit(0)

    def kills_itself(arm):
        if arm.position() < 0:
            os.kill(os.getpid(), signal.SIGKILL)

    def exits(arm):
        if arm.position() < 0:
            raise SystemExit(3)

    def ends_pytest(arm):
        if arm.position() < 0:
            import pytest
            pytest.exit("no robot", returncode=3)

    def eats_memory(arm):
        if arm.position() < 0:
            return len(bytearray(10**11))

    def diverges(arm):
        if arm.position() < 0:
            raise robot.Diverged("NaN in joint 3")

    def crashes_in_the_mutated_call(arm):
        arm.move_by(0.25)
        return arm.x

    def skips_itself(arm):
        if arm.position() < 0:
            import pytest
            pytest.skip("no robot")
"""
TESTS = """
    import mission
    import pytest
    from robot import Arm

    NAMES = [name for name in vars(mission) if callable(getattr(mission, name))]

    def positive(x):
        assert x > 0, "x must be positive"

    @pytest.mark.parametrize("name", NAMES)
    def test_mission(name):
        start = -0.5 if "refus" in name else 0.5
        result = getattr(mission, name)(Arm(start))
        if name == "noticed_by_the_test":
            assert result > 0
        if name == "noticed_by_the_test_in_a_helper":
            positive(result)
        if name == "handles_the_refusal":
            assert result is not None
"""
CONFIGURATION = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=."]
    timeout_seconds = 2
    memory = "3 GB"
"""
CRASH = """
    def crash(dx):
        \"\"\"As a native driver does that is given a value it never expected.\"\"\"
        import os
        import signal

        if dx == -0.25:
            os.kill(os.getpid(), signal.SIGSEGV)
        return 0.0
"""
#: function -> (verdict, by, words of the message)
EXPECTED = {
    "noticed_by_the_test": (Verdict.KILLED, By.CHECK, "assert -0.5 > 0"),
    "noticed_by_the_test_in_a_helper": (Verdict.KILLED, By.CHECK, "x must be positive"),
    "crashes": (Verdict.KILLED, By.EXCEPTION, "list index out of range"),
    "asserts_itself": (Verdict.KILLED, By.EXCEPTION, ""),
    "breaks_a_monitor": (Verdict.KILLED, By.CHECK, "never below zero"),
    "nobody_cares": (Verdict.SURVIVED, None, ""),
    "is_refused": (Verdict.REFUSED, None, "-1.25 is out of reach"),
    "handles_the_refusal": (Verdict.KILLED, By.CHECK, "is not None"),
    "handles_the_refusal_unnoticed": (Verdict.REFUSED, None, "-1.25 is out of reach"),
    "wraps_the_refusal": (Verdict.REFUSED, None, "-1.25 is out of reach"),
    "loops_forever": (Verdict.TIMEOUT, None, "processor time"),
    "hangs": (Verdict.TIMEOUT, None, "wall clock"),
    "leaves_the_process": (Verdict.ERROR, None, "exit code 0"),
    "kills_itself": (Verdict.ERROR, None, "signal 9"),
    "exits": (Verdict.KILLED, By.EXCEPTION, "3"),
    "ends_pytest": (Verdict.KILLED, By.CHECK, "exit code 3 instead of 0"),
    "eats_memory": (Verdict.ERROR, None, "memory limit"),
    "diverges": (Verdict.ERROR, None, "NaN in joint 3"),
    "crashes_in_the_mutated_call": (Verdict.KILLED, By.EXCEPTION, "signal 11"),
    "skips_itself": (Verdict.SURVIVED, None, ""),
}


@pytest.fixture(scope="module", params=["fork", REPLAY])
def campaign(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, dict[str, Outcome], dict[str, str]]:
    """One campaign per engine for the whole table: it is the slow part."""
    folder = tmp_path_factory.mktemp("verdicts")
    robot = ROBOT.replace("self.x += dx", "self.x += dx + crash(dx)") + CRASH
    write_project(folder, MISSION, TESTS, configuration=CONFIGURATION, robot=robot)
    before = fingerprint(folder)
    only = ("*:negate", "*:reverse")
    found = run(folder, only=only, engine=request.param)
    # on a busy machine the one that hangs is run once more, alone and by replay
    assert {outcome.engine for outcome in found.values() if outcome.beside is None} == {request.param}
    return folder, {key.split(":")[1]: outcome for key, outcome in found.items()}, before


@pytest.mark.parametrize("function", EXPECTED)
def test_the_mutant_ends_as_it_must(
    campaign: tuple[Path, dict[str, Outcome], dict[str, str]], function: str
) -> None:
    outcome = campaign[1][function]
    verdict, by, words = EXPECTED[function]
    assert (outcome.verdict, outcome.by) == (verdict, by), outcome.message
    assert words in (outcome.message or "")


def test_no_mutant_is_lost(campaign: tuple[Path, dict[str, Outcome], dict[str, str]]) -> None:
    assert campaign[1].keys() == EXPECTED.keys()


def test_every_kill_and_every_survivor_really_ran_mutated_code(
    campaign: tuple[Path, dict[str, Outcome], dict[str, str]],
) -> None:
    for function, outcome in campaign[1].items():
        if outcome.verdict in (Verdict.KILLED, Verdict.SURVIVED, Verdict.REFUSED):
            assert outcome.acted > 0, function
            assert outcome.example is not None or function in ("crashes_in_the_mutated_call", "ends_pytest")


def test_the_users_tree_is_byte_identical_afterwards(
    campaign: tuple[Path, dict[str, Outcome], dict[str, str]],
) -> None:
    assert fingerprint(campaign[0]) == campaign[2]


def test_nothing_temporary_is_left_in_mutabots_own_folder(
    campaign: tuple[Path, dict[str, Outcome], dict[str, str]],
) -> None:
    left = {path.name for path in (campaign[0] / ".mutabot").iterdir()}
    assert left <= {
        ".gitignore",
        "journal.sqlite",
        "journal.sqlite.lock",
        "journal.sqlite-wal",
        "journal.sqlite-shm",
    }
