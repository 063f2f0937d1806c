"""Disturbances of any program on MuJoCo, by the names of its model."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import mujoco
import pytest

import mutabot_world.mujoco as on_mujoco
from mutabot_world.change import NotInWorldError, NumberChange
from mutabot_world.files import parameters_of
from mutabot_world.patching import instances_of, rebind
from mutabot_world.tables import WorldTable

MODEL = """
<mujoco>
  <worldbody>
    <body name="stand" pos="0 0 1"><geom name="plate" type="box" size=".1 .1 .01"/></body>
    <body name="obj" pos="0 0 2">
      <freejoint/><geom name="objGeom" type="sphere" size=".05" mass=".2"/>
    </body>
    <body name="arm">
      <joint name="hinge" type="hinge"/><geom name="rod" type="capsule" size=".02 .1" mass="1"/>
    </body>
  </worldbody>
  <contact><pair geom1="objGeom" geom2="plate" friction=".8 .8 .01 .001 .001"/></contact>
  <actuator>
    <position name="servo" joint="hinge" kp="50"/><motor name="motor" joint="hinge" gear="2"/>
  </actuator>
  <sensor><jointpos name="angle" joint="hinge"/></sensor>
</mujoco>
"""


@pytest.fixture
def model() -> Iterator[Any]:
    """A model; what a disturbance puts around functions of MuJoCo is taken away."""
    kept = {name: getattr(mujoco, name) for name in ("mj_step", "mj_step1", "mj_forward")}
    yield mujoco.MjModel.from_xml_string(MODEL)
    for name, function in kept.items():
        rebind(getattr(mujoco, name), function)


def disturb(model: Any, function: str, kind: str, amount: float, names: str = "*", **options: Any) -> None:
    getattr(on_mujoco, function)(model, NumberChange(kind, amount), names=names, random=Random(1), **options)


def test_mass_takes_inertia_along(model: Any) -> None:
    mass, inertia, weight = model.body("obj").mass[0], model.body("obj").inertia[0], model.dof_invweight0[0]
    disturb(model, "mass", "scale", 1.0, "obj")
    assert model.body("obj").mass[0] == pytest.approx(2 * mass)
    assert model.body("obj").inertia[0] == pytest.approx(2 * inertia)
    assert model.dof_invweight0[0] == pytest.approx(weight / 2)


def test_friction_is_that_of_pairs_too(model: Any) -> None:
    disturb(model, "friction", "scale", -0.5, "obj*")
    assert model.pair_friction[0, 0] == pytest.approx(0.4)
    assert model.geom("objGeom").friction[0] == pytest.approx(0.5)
    assert model.geom("plate").friction[0] == pytest.approx(1.0)


def test_a_servo_keeps_its_setpoint_with_another_gain(model: Any) -> None:
    disturb(model, "gain", "scale", -0.5, "servo")
    assert (model.actuator_gainprm[0, 0], model.actuator_biasprm[0, 1]) == (25.0, -25.0)
    assert model.actuator_gainprm[1, 0] == 1.0


def test_a_position_is_off_also_after_a_framework_has_put_the_body_elsewhere(model: Any) -> None:
    data = mujoco.MjData(model)
    disturb(model, "position", "offset", 0.1, "stand", axis="x")
    mujoco.mj_step(model, data)
    assert model.body("stand").pos[0] == pytest.approx(0.1)
    model.body("stand").pos[:] = (0.3, 0.0, 1.0)
    mujoco.mj_resetData(model, data)
    mujoco.mj_forward(model, data)
    mujoco.mj_step(model, data)
    assert model.body("stand").pos[0] == pytest.approx(0.4)


def test_programs_that_hold_functions_under_names_of_their_own_are_disturbed(
    model: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    holder: Any = ModuleType("holder")
    holder.step = mujoco.mj_step
    monkeypatch.setitem(sys.modules, "holder", holder)
    disturb(model, "sensor", "offset", 0.5, "angle")
    data = mujoco.MjData(model)
    holder.step(model, data)
    assert data.sensordata[0] == pytest.approx(0.5, abs=0.01)


def test_a_sensor_reads_more(model: Any) -> None:
    disturb(model, "sensor", "offset", 0.5, "angle")
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    assert data.sensordata[0] == pytest.approx(0.5, abs=0.01)


def test_names_that_match_nothing_are_said(model: Any) -> None:
    with pytest.raises(NotInWorldError, match="no body is named 'cup'; there are: arm, obj"):
        disturb(model, "mass", "scale", 1.0, "cup")


def test_models_that_python_cannot_refer_to_are_found(model: Any) -> None:
    holder = {"model": model}
    assert any(
        instance is model for instance in instances_of(["mujoco:MjModel", "mujoco:MjModel.from_xml_path"])
    )
    assert holder


def test_a_project_says_by_name_which_things_are_meant(tmp_path: Path) -> None:
    shipped = ["mutabot_world:mujoco.toml"]
    names = {"parameters": shipped, "only": ["mass", "gravity"], "names": {"mass": "obj*"}}
    found = parameters_of(WorldTable.model_validate(names), tmp_path)
    assert {table.name: table.names for table in found} == {"mass": "obj*", "gravity": "*"}
