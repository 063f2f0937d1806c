"""A test's timer goes off in the process of a mutant as in the test's own."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import REPLAY, run, write_project

#: without the command it searches until the timer interrupts it, which the test does not mind
MISSION = """
    class Interrupted(Exception):
        pass

    def interrupt(number, frame):
        raise Interrupted

    def search(arm):
        arm.move_by(0.25)
        try:
            while arm.x == 0.0:
                pass
        except Interrupted:
            return None
        return arm.x
"""
TESTS = """
    import signal

    import mission
    from robot import Arm

    def test_searches():
        signal.signal(signal.{signal}, mission.interrupt)
        signal.setitimer(signal.{timer}, 0.2)
        try:
            assert mission.search(Arm()) in (0.25, None)
        finally:
            signal.setitimer(signal.{timer}, 0.0)
"""
SIGNALS = {"ITIMER_REAL": "SIGALRM", "ITIMER_VIRTUAL": "SIGVTALRM", "ITIMER_PROF": "SIGPROF"}


@pytest.mark.parametrize("engine", ["fork", REPLAY])
@pytest.mark.parametrize("timer", SIGNALS)
def test_it_ends_a_loop_that_only_the_mutant_enters(tmp_path: Path, timer: str, engine: str) -> None:
    folder = write_project(tmp_path, MISSION, TESTS.format(timer=timer, signal=SIGNALS[timer]))
    found = run(folder, engine=engine, only=("mission.py:search:arm.move_by#1:call:skip",))
    assert [outcome.verdict for outcome in found.values()] == [Verdict.SURVIVED]
