"""What docs/world.md shows is right: its examples run, and the parameters that it names are there."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import mutabot_cell
import mutabot_ros
import mutabot_world
from mutabot_world.tables import ParameterFile, WorldTable

from .belts import project, run, told

PAGE = (Path(__file__).parents[3] / "docs" / "world.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
SHIPPED = {
    "What the paper names, in the simulated cell": Path(mutabot_cell.__file__).with_name("world.toml"),
    "Any program on MuJoCo": Path(mutabot_world.__file__).with_name("mujoco.toml"),
    "Any program on PyBullet": Path(mutabot_world.__file__).with_name("pybullet.toml"),
    "Nodes of ROS": Path(mutabot_ros.__file__).with_name("ros2.toml"),
}


def names(file: Path) -> set[str]:
    return {
        parameter.name
        for parameter in ParameterFile.model_validate(tomllib.loads(file.read_text())).parameter
    }


@pytest.mark.parametrize("block", BLOCKS)
def test_each_table_is_one_that_is_read(block: str) -> None:
    table = tomllib.loads(block)["tool"]["mutabot"]["world"]
    read = WorldTable.model_validate(table)
    shipped = set().union(*map(names, SHIPPED.values()))
    assert {*read.names} <= shipped
    assert all(name in shipped or "*" in name for name in read.only)


@pytest.mark.parametrize("section", SHIPPED)
def test_the_page_names_every_shipped_parameter(section: str) -> None:
    text = PAGE.partition(f"## {section}")[2].partition("\n## ")[0]
    named = set(re.findall(r"`([a-z][a-z0-9 ]*)`", text))
    assert names(SHIPPED[section]) <= named


def test_the_example_of_a_parameter_of_one_s_own_runs(tmp_path: Path) -> None:
    (block,) = [example for example in BLOCKS if "[[tool.mutabot.world.parameter]]" in example]
    parameter = block.partition("[[")[2]
    found = run(project(tmp_path, f"[[{parameter}"), "-o", "rounds=1")
    assert found["speed +"]["ends"] == {"0.01": "lived with", "10": "suffered unseen", "50": "noticed"}
    page = tmp_path / "page.html"
    told(tmp_path, "--html", str(page))
    text = page.read_text(encoding="utf-8")
    assert "a belt that is 50 % faster, not one of 10 %" in text
    assert "complete, 1 round<" in text
