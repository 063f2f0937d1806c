"""The names of the engines."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.errors import UsageError
from tests.campaign.project import run, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.5)
    """
TESTS = """
    from mission import run
    from robot import Arm

    def test_run():
        run(Arm())
    """


def test_an_engine_that_there_is_not_is_reported_before_the_tests_run(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"'brunch'.*fork"):
        run(write_project(tmp_path, MISSION, TESTS), engine="brunch")
