"""From its verdict to the journal an outcome visits few files of the campaign, reuse included."""

from __future__ import annotations

import sys
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import mutabot
from mutabot.campaign import verdict
from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from tests.campaign.project import Quiet, request_for, write_project
from tests.campaign.scripted import Script

MISSION = "def run(arm):\n    arm.move_by(0.25)\n"
TESTS = """
    import mission
    from robot import Arm

    def test_run():
        mission.run(Arm())
"""


@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_an_outcome_visits_few_files(
    tmp_path: Path, script: Script, monkeypatch: pytest.MonkeyPatch, engine: str
) -> None:
    script.kill("reverse")
    root = Path(mutabot.__file__).parent
    files: set[str] = set()
    judged, add = verdict.judge, Journal.add_outcome

    def look(frame: FrameType, event: str, argument: object) -> None:
        path = Path(frame.f_code.co_filename)
        if event == "call" and path.is_relative_to(root):
            files.add(path.relative_to(root).as_posix())

    def judge(campaign: Any, run: Any) -> Any:
        if run.mutant.operator == "reverse":
            files.clear()
            sys.setprofile(look)
        return judged(campaign, run)

    def add_outcome(*arguments: Any, **named: Any) -> None:
        sys.setprofile(None)
        add(*arguments, **named)

    monkeypatch.setattr(verdict, "judge", judge)
    monkeypatch.setattr(Journal, "add_outcome", add_outcome)
    write_project(tmp_path, MISSION, TESTS)
    run_campaign(request_for(tmp_path, engine=engine, only=("reverse",)), Quiet())
    campaign = {file for file in files if file.startswith("campaign/")}
    assert len(campaign) <= 6, sorted(campaign)
