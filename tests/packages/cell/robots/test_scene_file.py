"""A whole cell from one file: robots, fixtures and parts where the file puts them."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot_cell import BadModel, Cell, RobotModel, Scene

from .test_files import HOME, arm

THINGS = """
<geom name="table" type="box" size="0.3 0.4 0.05" pos="0.9 0 0.45" friction="0.5"/>
<geom name="ball" type="sphere" size="0.1" pos="3 3 3"/>
<body name="brick" pos="0.9 0.1 0.52"><freejoint/><geom type="box" size="0.04 0.03 0.02" mass="0.3"/></body>
<body name="can" pos="0.9 -0.1 0.55"><freejoint/><geom type="cylinder" size="0.02 0.05" mass="0.2"/></body>
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "cell.xml"
    text = arm().replace('<body name="link 1" pos="0 0 0.2">', '<body name="link 1" pos="0.2 0 0.5">')
    path.write_text(text.replace("<worldbody>", f"<worldbody>{THINGS}"), encoding="utf-8")
    return path


def test_everything_stands_where_the_file_says_and_rests_there(file: Path) -> None:
    robot = RobotModel.from_mjcf(file, tool_site="flange", home=HOME, root="link 1")
    cell = Cell.from_mjcf(file, 1, robots={"arm": robot}, parts=["brick", "can"], fixtures=["table"])
    cell.wait(1.0)
    assert (robot.base.x, robot.base.y, robot.base.z) == (0.2, 0.0, 0.5)
    for name, y in (("brick", 0.1), ("can", -0.1)):
        place = cell.truth.box_position(name)
        assert (place.x, place.y, place.z) == pytest.approx((0.9, y, 0.5), abs=0.003)
        assert cell.truth.box_tilt(name) < 0.1


def test_sizes_masses_and_friction_are_the_files(file: Path) -> None:
    scene = Scene.from_mjcf(file, parts=["brick", "can"], fixtures=["table"])
    brick, can = scene.parts
    assert brick.extent == pytest.approx((0.08, 0.06, 0.04))
    assert can.extent == pytest.approx((0.04, 0.04, 0.1))
    assert (brick.mass, can.mass) == pytest.approx((0.3, 0.2))
    assert scene.fixtures[0].size == pytest.approx((0.6, 0.8, 0.1))
    assert scene.fixtures[0].friction == 0.5


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"parts": ["box"]}, r"no body or geom 'box'; bodies: .*'brick'"),
        ({"parts": ["table"]}, r"part 'table' .* does not weigh anything"),
        ({"fixtures": ["ball"]}, r"fixture 'ball' .* is not a box"),
    ],
    ids=["missing", "weightless", "round"],
)
def test_what_a_scene_cannot_take_is_named(file: Path, said: dict[str, list[str]], message: str) -> None:
    with pytest.raises(BadModel, match=message):
        Scene.from_mjcf(file, parts=said.get("parts", ()), fixtures=said.get("fixtures", ()))
