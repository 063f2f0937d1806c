"""Tests that take away parts of Python while the program runs, which ours must not need then."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import REPLAY, run, write_project

MISSION = """
    class Tool:
        pass

    def go(arm):
        arm.move_by(0.25)
        tool = Tool()
        if tool:
            arm.move_by(0.125)
        return arm.position()
"""
#: plain pytest passes as it is, and fails if a command is left out, done twice or reversed
TESTS = """
    import builtins
    import sys
    from unittest import mock

    import mission
    from robot import Arm

    def test_goes():
        arm = Arm()
        taken = {taken}
        with taken:
            mission.go(arm)
        assert arm.x == 0.375
"""
TAKEN = {
    "modules": "mock.patch.dict(sys.modules, clear=True)",
    "imports": "mock.patch('builtins.__import__', side_effect=ImportError('no'))",
    "compiler": "mock.patch.multiple(builtins, exec=None, compile=None, eval=None)",
    "frames": "mock.patch('sys._getframe', side_effect=RuntimeError('no'))",
}


#: two commands that are left out, and a change of what is no plain value
MUTANTS = ("mission.py:go:arm.move_by#?:call:skip", "mission.py:go:tool#*")


@pytest.mark.parametrize("engine", ["auto", REPLAY])
@pytest.mark.parametrize(
    "taken",
    [name if name == "imports" else pytest.param(name, marks=pytest.mark.whole) for name in TAKEN],
)
def test_mutants_act_and_controls_count_without_it(tmp_path: Path, taken: str, engine: str) -> None:
    folder = write_project(tmp_path, MISSION, TESTS.format(taken=TAKEN[taken]))
    found = run(folder, engine=engine, families=("robot", "conventional"), only=MUTANTS)
    assert len(found) > 2
    assert {outcome.verdict for outcome in found.values()} == {Verdict.KILLED}
