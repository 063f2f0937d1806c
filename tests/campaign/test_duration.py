"""How long a run will take is said before it begins: by ``list``, by ``check``, and in their JSON."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mutabot.campaign.duration import Duration
from mutabot.cli.app import main
from tests.campaign.project import write_project
from tests.campaign.scripted import Script

MISSION = "def go(arm):\n    arm.move_by(0.1)\n    arm.move_by(0.2)\n"
TESTS = """
    from robot import Arm
    import mission

    def test_goes():
        mission.go(Arm())
"""


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.3, "about 5 s for 6 runs, 2 at a time"),
        (42.0, "about 40 s for 6 runs, 2 at a time"),
        (260.0, "about 4 min 30 s for 6 runs, 2 at a time"),
        (7300.0, "about 2 h for 6 runs, 2 at a time"),
    ],
)
def test_an_estimate_is_rounded_to_what_is_known_of_it(seconds: float, text: str) -> None:
    assert Duration(6, 2, seconds).text == text


def data(project: Path, capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, float]:
    assert main(["-C", str(project), *arguments, "--json"]) == 0
    found: dict[str, float] = json.loads(capsys.readouterr().out)
    return found


@pytest.mark.parametrize("command", ["list", "check"])
def test_more_rounds_take_longer_and_more_jobs_less(
    tmp_path: Path, script: Script, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    script.original = lambda run: {"wall": 3.0}
    project = write_project(tmp_path, MISSION, TESTS)
    single = data(project, capsys, command, "-j", "1")
    more = data(project, capsys, command, "-j", "1", "--rounds", "3")
    double = data(project, capsys, command, "-j", "2")
    assert single["seconds"] > 3.0
    assert more["runs"] == 3 * single["runs"] == 3 * double["runs"]
    assert more["seconds"] == pytest.approx(3 * single["seconds"], rel=0.2)
    assert double["seconds"] == pytest.approx(single["seconds"] / 2, rel=0.2)


def test_both_commands_say_it(tmp_path: Path, script: Script, capsys: pytest.CaptureFixture[str]) -> None:
    project = write_project(tmp_path, MISSION, TESTS)
    assert main(["-C", str(project), "list"]) == 0
    assert "`mutabot run` takes about " in capsys.readouterr().out
    assert main(["-C", str(project), "check"]) == 0
    assert "\ntime      about " in capsys.readouterr().out
