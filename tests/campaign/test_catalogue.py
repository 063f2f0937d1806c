"""Operators of the catalogue in a campaign: who applies nowhere, and who needs a call that raises."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.check import check
from mutabot.campaign.run import plan_only
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


def test_check_names_each_operator_that_applies_nowhere_with_the_reason(folder: Path) -> None:
    report = check(request_for(folder, families=("catalogue",)), Quiet())
    lines = [line for line in report.lines if line.startswith("nowhere")]
    told = {line.split()[1].rstrip(":"): line.partition(": ")[2] for line in lines}
    assert told == report.data["nowhere"]
    assert (
        told["quaternion-order"]
        == "nothing here has what it needs: written and read quantities of kind quaternion"
    )
    assert told["stuck-reading"] == "takes 2 calls in a test, and no test makes more than 1"
    assert not {"cm-for-m", "swap-next", "saturated-reading"} & {*told}


@pytest.mark.whole
def test_check_says_nothing_of_a_catalogue_that_nobody_asked_for(folder: Path) -> None:
    report = check(request_for(folder), Quiet())
    assert not [line for line in report.lines if line.startswith("nowhere")]


def test_a_refusal_goes_unreported_only_where_a_call_raises(folder: Path) -> None:
    mutants, left_out = plan_only(request_for(folder, families=("catalogue",)), Quiet())[:2]
    planned = [one.id for one in mutants if one.operator == "unreported-refusal"]
    assert planned == ["mission.py:run:arm.move_by#2:call:unreported-refusal"]
    reasons = [one.reason for one in left_out if one.id.endswith("unreported-refusal")]
    assert reasons == ["no call raises in the baseline"]
