"""What a fork would not have: locks on files and signals that wait are there for mutants as for the test."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import REPLAY, run, write_project

#: where the robot is not where it was sent, the file is locked once more, which must fail
LOCKED = """
    import fcntl

    def go(arm, path):
        with open(path, "w") as first:
            fcntl.flock(first, fcntl.LOCK_EX)
            arm.move_by(0.25)
            if arm.x != 0.25:
                with open(path) as second:
                    try:
                        fcntl.flock(second, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    except OSError:
                        return "as usual"
                return "locked twice"
        return "as usual"
"""
#: there, the signal that waits is heard
WAITING = """
    import signal

    def go(arm, path):
        heard = []
        signal.signal(signal.SIGUSR1, lambda number, frame: heard.append(number))
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGUSR1])
        signal.raise_signal(signal.SIGUSR1)
        arm.move_by(0.25)
        if arm.x == 0.25:
            signal.sigwait([signal.SIGUSR1])
            heard.append("taken")
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGUSR1])
        return "as usual" if heard else "lost"
"""
#: a mock that stands for ``open`` hears of no fork
OPEN = """
    def go(arm, path):
        with open("plan") as plan:
            arm.move_by(float(plan.read()))
        return "as usual"
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
@pytest.mark.parametrize("mission", [LOCKED, WAITING], ids=["lock", "signal"])
def test_a_mutant_has_it(tmp_path: Path, mission: str, engine: str) -> None:
    tests = """
    import mission
    from robot import Arm

    def test_goes(tmp_path):
        assert mission.go(Arm(), tmp_path / "lock") == "as usual"
    """
    folder = write_project(tmp_path, mission, tests)
    found = run(folder, engine=engine, only=("skip", "repeat"))
    assert [outcome.verdict for outcome in found.values()] == [Verdict.SURVIVED] * 2


def test_a_mock_in_the_place_of_open_hears_of_no_fork(tmp_path: Path) -> None:
    tests = """
    from unittest import mock

    import mission
    from robot import Arm

    def test_goes():
        arm = Arm()
        with mock.patch("builtins.open", mock.mock_open(read_data="0.25")) as opened:
            mission.go(arm, None)
            opened.assert_called_once_with("plan")
        assert arm.x == 0.25
    """
    folder = write_project(tmp_path, OPEN, tests)
    found = run(folder, engine="fork", only=("skip", "repeat"))
    assert [outcome.verdict for outcome in found.values()] == [Verdict.KILLED] * 2
