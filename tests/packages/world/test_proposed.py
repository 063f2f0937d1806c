"""What `mutabot init` proposes of the simulated world: parameters by the names of the models of the tests."""

from __future__ import annotations

import tomllib
from pathlib import Path

from mutabot_world.files import parameters_of
from mutabot_world.tables import WorldTable
from tests.plugins.test_plugins import mutabot

from .test_mujoco import MODEL


def test_a_parameter_is_proposed_for_each_thing_of_the_model(tmp_path: Path) -> None:
    (tmp_path / "model.xml").write_text(MODEL.replace('<position name="servo"', "<position"))
    (tmp_path / "arm.py").write_text(
        """
import mujoco


class Arm:
    def __init__(self):
        self.model = mujoco.MjModel.from_xml_path("model.xml")
        self.data = mujoco.MjData(self.model)

    def move(self, angle):
        self.data.ctrl[0] = angle
        mujoco.mj_step(self.model, self.data)
"""
    )
    (tmp_path / "mission.py").write_text("import arm\n\ndef run():\n    arm.Arm().move(0.5)\n")
    (tmp_path / "test_mission.py").write_text("import mission\n\ndef test_it():\n    mission.run()\n")
    done = mutabot(None, tmp_path, "init", "mission.py")
    assert done.returncode == 0, done.stderr
    assert "[world]: `mutabot run --family world` disturbs the simulated world" in done.stdout
    table = tomllib.loads((tmp_path / "mutabot.toml").read_text(encoding="utf-8"))["world"]
    found = {one.name: one for one in parameters_of(WorldTable.model_validate(table), tmp_path)}
    assert [*found] == ["mass of obj", "friction of objGeom", "gain of hinge", "gain of motor", "gravity"]
    assert (found["mass of obj"].names, found["mass of obj"].more) == ("obj", "")
    assert found["mass of obj"].ladder == (100, 300, 700, 1500, 3100)
