"""Pictures as files."""

from __future__ import annotations

from pathlib import Path

import pytest
from mutabot.report.thresholds.picture import Picture, check_picture, write_drawing

from mutabot.campaign.run import run_campaign
from mutabot.errors import UsageError
from tests.campaign.conftest import script as script  # noqa: PLC0414  # a fixture
from tests.campaign.project import Quiet, request_for, write_project
from tests.campaign.scripted import Script


@pytest.mark.parametrize("name", ["ends", "ends.jpg", "nowhere/ends.svg", ".", "ends.svg.txt"])
def test_a_picture_that_cannot_be_drawn_is_a_usage_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UsageError):
        check_picture(Path(name))


def test_a_picture_of_another_format_is_told_the_name_it_may_have(tmp_path: Path) -> None:
    check_picture(tmp_path / "ends.svg")
    with pytest.raises(UsageError, match=r"ends\.png is no picture .* write .*ends\.svg$"):
        check_picture(tmp_path / "ends.png")


def test_what_mutabot_writes_into_a_project_does_not_make_it_run_again(
    tmp_path: Path, script: Script
) -> None:
    script.kill("reverse")
    mission = "def run(arm):\n    arm.move_by(0.5)\n"
    test = "from mission import run\nfrom robot import Arm\n\ndef test_it():\n    run(Arm())\n"
    selections = {"used.txt": "mission.py:run:arm.move_by#1:dx:reverse\n", "other.txt": "mission.py:*\n"}
    folder = write_project(tmp_path, mission, test, more={"used.txt": selections["used.txt"]})
    request = request_for(folder, engine="replay", selection=folder / "used.txt")
    run_campaign(request, Quiet())
    write_drawing(Picture(10, 10, [], []), folder / "ends.svg", by="mutabot thresholds")
    (folder / "other.txt").write_text(selections["other.txt"])
    again = Quiet()
    run_campaign(request, again)
    assert any(line.startswith("reused all") for line in again.lines)
    (folder / "arm.urdf").write_text('<mesh file="ends.svg"/>')
    after = Quiet()
    run_campaign(request, after)
    assert any("arm.urdf is new, ends.svg is new" in line for line in after.lines)
