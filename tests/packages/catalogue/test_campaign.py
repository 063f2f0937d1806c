"""Operators of the catalogue in a campaign: which of them need a call that raises."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import plan_only
from tests.campaign.project import Quiet, request_for, write_project

MISSION = """
    from robot import Refused

    def run(arm):
        arm.move_by(0.25)
        try:
            arm.move_by(9.0)
        except Refused:
            pass
        return arm.position()
    """
TESTS = """
    import mission
    from robot import Arm

    def test_it_moves():
        assert mission.run(Arm()) == 0.25
    """


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_project(tmp_path, MISSION, TESTS)
    return tmp_path


def test_a_refusal_goes_unreported_only_where_a_call_raises(folder: Path) -> None:
    planned = plan_only(request_for(folder, families=("catalogue",)), Quiet())
    mutants, left_out = planned.mutants, planned.left_out
    planned = [mutant.id for mutant in mutants if mutant.operator == "unreported-refusal"]
    assert planned == ["mission.py:run:arm.move_by#2:call:unreported-refusal"]
    reasons = [omission.reason for omission in left_out if omission.id.endswith("unreported-refusal")]
    assert reasons == ["no call raises in the baseline"]
