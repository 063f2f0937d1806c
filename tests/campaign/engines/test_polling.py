"""A program that polls makes thousands of calls before it comes to other sites: these are judged as any."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.model import Verdict
from mutabot.model.events import TRACE_LIMIT
from mutabot.results.results import read_results
from tests.campaign.project import REPLAY, Quiet, request_for, write_project

PROGRAM = f"""
    import sys

    def wait(arm):
        for _ in range({TRACE_LIMIT + 500}):
            arm.position()

    def run(arm):
        wait(arm)
        arm.move_by(0.25)
        wait(arm)
        arm.move_by(0.5)
        return arm.position()

    if __name__ == "__main__":
        import robot

        sys.exit(0 if run(robot.Arm()) == 0.75 else 1)
"""
INSIDE = """
    import mission
    import robot

    def test_mission():
        assert mission.run(robot.Arm()) == 0.75
"""
BESIDE = """
    import threading
    import mission
    import robot

    def test_mission():
        arm = robot.Arm()
        thread = threading.Thread(target=mission.run, args=(arm,))
        thread.start()
        thread.join()
        assert arm.x == 0.75
"""
BELOW = """
    import subprocess
    import sys

    def test_mission():
        assert subprocess.run([sys.executable, "mission.py"]).returncode == 0
"""
AFTER_ANOTHER = """
    import mission
    import robot

    def test_waiting():
        mission.wait(robot.Arm())

    def test_mission():
        assert mission.run(robot.Arm()) == 0.75
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
@pytest.mark.parametrize(
    "tests",
    [
        pytest.param(INSIDE, id="in", marks=pytest.mark.whole),
        pytest.param(BESIDE, id="beside"),
        pytest.param(BELOW, id="below", marks=pytest.mark.whole),
        pytest.param(AFTER_ANOTHER, id="two", marks=pytest.mark.whole),
    ],
)
def test_what_comes_after_long_polling_is_judged(tmp_path: Path, tests: str, engine: str) -> None:
    write_project(tmp_path, PROGRAM, tests)
    path = run_campaign(request_for(tmp_path, engine=engine, only=("skip",)), Quiet())
    with Journal.open(path) as journal:
        results = read_results(journal)
    verdicts = {result.mutant.site.place: result.outcomes[0].verdict for result in results.mutants}
    assert verdicts == {"mission.py:10:5": Verdict.KILLED, "mission.py:12:5": Verdict.KILLED}
    assert not results.untested.unreached_calls
