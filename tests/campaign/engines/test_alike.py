"""What a test may look at is in a fork as in the original, or replay judges what the test does."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import run, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.5)
        arm.move_by(-0.5)
"""
TESTS = """
    import gc
    import os
    import weakref

    import pytest

    import mission
    from robot import Arm

    def numbers():
        return sorted(os.listdir("/proc/self/fd"))

    @pytest.fixture(autouse=True)
    def leaves_nothing_open():
        before = numbers()
        yield
        assert numbers() == before

    def test_run():
        arm = Arm()
        arm.itself, known, count = arm, weakref.ref(arm), len(gc.get_referrers(os))
        mission.run(arm)
        assert len(gc.get_referrers(os)) == count
        del arm
        gc.collect()
        assert known() is None

    def test_runs_again():
        mission.run(Arm())
"""


def test_a_fork_has_the_descriptors_of_its_parent_and_what_the_collector_sees(tmp_path: Path) -> None:
    found = run(write_project(tmp_path, MISSION, TESTS), engine="fork", only=("skip", "repeat"))
    assert len(found) == 4
    assert {one.verdict for one in found.values()} == {Verdict.SURVIVED}


UNLIKE = """
    import os
    import time

    import mission
    from robot import Arm

    def test_alike():
        mission.forgets(Arm())

    def test_time():
        before = time.process_time()
        mission.moves(Arm())
        assert time.process_time() >= before

    def test_parent():
        assert os.getppid() != 0
"""
FUNCTIONS = """
    def forgets(arm):
        arm.move_by(0.5)

    def moves(arm):
        arm.move_by(0.5)
"""


def test_where_an_identity_fails_in_a_fork_replay_judges(tmp_path: Path) -> None:
    if os.geteuid():
        pytest.skip("only root's forks have a parent of another namespace")
    found = run(write_project(tmp_path, FUNCTIONS, UNLIKE), engine="auto", only=("reverse",))
    assert {one.mutant.split(":")[1]: (one.verdict, one.engine) for one in found.values()} == {
        "forgets": (Verdict.SURVIVED, "replay"),
        "moves": (Verdict.SURVIVED, "replay"),
    }
