"""Runs that see each other's files run one after the other."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import CONFIGURATION, run, write_project

MISSION = "def run(arm):\n    arm.move_by(0.25)\n"
TESTS = """
    import os
    import time
    import mission
    from robot import Arm

    def test_nobody_is_here_at_the_same_time():
        descriptor = os.open("busy", os.O_CREAT | os.O_EXCL)
        try:
            mission.run(Arm())
            time.sleep(0.5)
        finally:
            os.close(descriptor)
            os.unlink("busy")
"""


@pytest.mark.whole
def test_runs_whose_files_are_not_private_never_meet(tmp_path: Path) -> None:
    folder = write_project(tmp_path, MISSION, TESTS, configuration=f"{CONFIGURATION}private_files = false\n")
    found = run(folder, jobs=4)
    assert {outcome.verdict for outcome in found.values()} == {Verdict.SURVIVED}
