"""The executor without processes reports what processes report, or it would prove nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign import preparation
from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from tests.campaign.project import REPLAY, Quiet, request_for, write_project
from tests.campaign.scripted import READING, Script

MISSION = f"""
    def go(arm):
        arm.move_by({READING})
        arm.move_by(0.25)
        arm.move_by(-0.25)

    def look(arm):
        return arm.position()
"""
TESTS = f"""
    import mission
    from robot import Arm

    def test_goes():
        arm = Arm()
        mission.go(arm)
        assert arm.x == {READING}

    def test_looks():
        mission.look(Arm({READING}))
"""


def campaign(folder: Path, engine: str) -> tuple[Any, ...]:
    """The plan, the controls, and how each mutant ended."""
    write_project(folder, MISSION, TESTS)
    request = request_for(folder, engine=engine, only=("skip", "reverse", "negate"))
    with Journal.open(run_campaign(request, Quiet())) as journal:
        ends = {
            outcome.mutant: (
                outcome.verdict,
                outcome.by,
                outcome.test,
                outcome.hits,
                outcome.tests,
                outcome.engine,
            )
            for outcome in journal.outcomes()
        }
        controls = {(control.test_file, control.control, control.ok) for control in journal.controls()}
        return journal.mutants(), ends, controls


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_a_scripted_campaign_is_a_real_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, engine: str
) -> None:
    real = campaign(tmp_path / "real", engine)
    script = Script()
    script.kill(":go:arm.move_by")
    monkeypatch.setattr(preparation, "open_executor", script.opened)
    assert campaign(tmp_path / "scripted", engine) == real
