"""What `mutabot init` proposes of the simulated world: parameters by the names of the models of the tests."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from mutabot_world.files import parameters_of
from mutabot_world.tables import WorldTable
from tests.plugins.test_plugins import mutabot

from .test_mujoco import MODEL

ARM = """
<robot name="arm">
  <link name="stand"/>
  <link name="rod">
    <inertial><mass value="2"/><inertia ixx=".1" iyy=".2" izz=".3" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size=".1 .1 .1"/></geometry></collision>
  </link>
  <joint name="hinge" type="revolute">
    <parent link="stand"/><child link="rod"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="50" velocity="5"/><dynamics damping=".5"/>
  </joint>
</robot>
"""


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
    found = {
        parameter.name: parameter for parameter in parameters_of(WorldTable.model_validate(table), tmp_path)
    }
    assert [*found] == ["mass of obj", "friction of objGeom", "gain of hinge", "gain of motor", "gravity"]
    assert (found["mass of obj"].names, found["mass of obj"].more) == ("obj", "")
    assert found["mass of obj"].ladder == (100, 300, 700, 1500, 3100)


def test_parameters_are_proposed_for_the_bodies_that_a_program_loads_into_pybullet(tmp_path: Path) -> None:
    pytest.importorskip("pybullet")
    (tmp_path / "arm.urdf").write_text(ARM)
    (tmp_path / "arm.py").write_text(
        """
import pybullet


class Arm:
    def __init__(self):
        self.client = pybullet.connect(pybullet.DIRECT)
        pybullet.setGravity(0, 0, -9.81)
        self.body = pybullet.loadURDF("arm.urdf", useFixedBase=True)
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.1, 0.1, 0.1])
        self.box = pybullet.createMultiBody(0.5, shape, basePosition=[1, 0, 1])

    def move(self, angle):
        pybullet.setJointMotorControl2(self.body, 0, pybullet.POSITION_CONTROL, angle)
        pybullet.stepSimulation()
"""
    )
    (tmp_path / "mission.py").write_text("import arm\n\ndef run():\n    arm.Arm().move(0.5)\n")
    (tmp_path / "test_mission.py").write_text("import mission\n\ndef test_it():\n    mission.run()\n")
    done = mutabot(None, tmp_path, "init", "mission.py")
    assert done.returncode == 0, done.stderr
    table = tomllib.loads((tmp_path / "mutabot.toml").read_text(encoding="utf-8"))["world"]
    found = {
        parameter.name: parameter for parameter in parameters_of(WorldTable.model_validate(table), tmp_path)
    }
    assert [*found] == [
        "mass of body 1", "friction of body 1", "gain of hinge", "damping of hinge", "gravity",
    ]  # fmt: skip
    assert found["gravity"].of == ("pybullet:connect", "mutabot_world.pybullet:Pull")
    assert found["mass of body 1"].names == "body 1"
