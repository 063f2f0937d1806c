"""How robots of files are drawn."""

from __future__ import annotations

import numpy as np
import pytest

from mutabot_cell import Cell, robots
from mutabot_cell.display.looks.style import LOOKS
from mutabot_cell.display.looks.visual import VisualModel

from .conftest import robot_named


def shown(visual: VisualModel, body: str) -> int:
    """How many meshes that are only looked at a body has."""
    model = visual.model
    return int(((model.geom_bodyid == model.body(body).id) & (model.geom_group == LOOKS)).sum())


@pytest.mark.parametrize("name", ["ur5e", "panda"])
def test_links_and_gripper_of_a_file_are_drawn_by_its_meshes_where_they_are(name: str) -> None:
    cell = Cell(1, robot=robot_named(name).with_tool(robots.robotiq_2f85()))
    cell.arm.move_by(z=0.05)
    visual = VisualModel(cell.simulation)
    visual.pose()
    simulated, state = cell.simulation.model, cell.simulation.data
    assert simulated.nmesh < visual.model.nmesh
    links = [simulated.body(simulated.jnt_bodyid[number]).name for number in range(6)]
    assert all(shown(visual, link) for link in links)
    assert shown(visual, "tool/left_pad")
    for link in links:
        np.testing.assert_allclose(visual.data.body(link).xpos, state.body(link).xpos, atol=1e-3)


def test_two_robots_of_one_file_are_both_drawn() -> None:
    arm = robot_named("ur5e")
    base = arm.base
    left, right = (arm.at(type(base)(*place, 0.9, 0.0, 0.0, 0.0)) for place in ((0.0, -0.8), (0.0, 0.8)))
    cell = Cell(1, robots={"left": left, "right": right})
    visual = VisualModel(cell.simulation)
    assert shown(visual, "left/forearm_link") == shown(visual, "right/forearm_link") > 0


def test_a_robot_of_a_file_remembers_it() -> None:
    arm = robot_named("ur5e")
    assert arm.file is not None
    assert arm.file.name == "ur5e.xml"
    assert robots.gen3().file is None
