"""Workers and processes that begin warm give every mutant the outcome that fresh ones give it."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.border.starter import is_supported
from mutabot.model import Outcome, Verdict
from mutabot.model.outcome import same_end
from tests.campaign.project import run, write_project

pytestmark = pytest.mark.skipif(is_supported() is not None, reason=str(is_supported()))

MISSION = """
    from robot import Arm

    LIFT = 0.25

    def run(arm):
        arm.move_by(0.5)
        if arm.position() > 0:
            arm.move_by(LIFT)

    if __name__ == "__main__":
        arm = Arm()
        run(arm)
        print(arm.x)
    """
TESTS = """
    import subprocess
    import sys

    from mission import run
    from robot import Arm

    def test_alone():
        done = subprocess.run([sys.executable, "mission.py"], capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stderr
        assert done.stdout.strip() == "0.75"

    def test_here():
        arm = Arm()
        run(arm)
        assert arm.x > 0
    """


@pytest.mark.whole
def test_the_engines_agree_where_tests_start_processes(tmp_path: Path) -> None:
    project = write_project(tmp_path, MISSION, TESTS)
    found: dict[str, dict[str, Outcome]] = {
        engine: run(project, engine=engine, rounds=1, fresh=True) for engine in ("replay", "auto")
    }
    assert found["auto"].keys() == found["replay"].keys()
    for mutant, outcome in found["auto"].items():
        assert same_end(outcome, found["replay"][mutant]), mutant
    verdicts = {one.verdict for one in found["auto"].values()}
    assert {Verdict.KILLED, Verdict.SURVIVED} & verdicts
    assert "warm" in {one.engine for one in found["auto"].values()}
