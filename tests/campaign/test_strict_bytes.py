"""A program that Python runs with ``-bb``, by which a text compared with bytes is an error."""

from __future__ import annotations

from pathlib import Path

from mutabot.model import Verdict
from tests.campaign.project import run, write_project

MISSION = """
    from robot import Arm

    def go(arm):
        arm.move_by(0.25)
        return arm.position()

    if __name__ == "__main__":
        print(go(Arm()))
"""
TESTS = """
    import subprocess
    import sys

    def test_prints_where_it_is():
        done = subprocess.run([sys.executable, "-bb", "mission.py"], capture_output=True, text=True)
        assert (done.returncode, done.stdout, done.stderr) == (0, "0.25\\n", "")
"""


def test_nothing_of_ours_compares_them(tmp_path: Path) -> None:
    folder = write_project(tmp_path, MISSION, TESTS)
    found = run(folder, families=("robot", "conventional"), only=("mission.py:go:arm.move_by#1:call:skip",))
    assert [outcome.verdict for outcome in found.values()] == [Verdict.KILLED]
