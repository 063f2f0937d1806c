"""Disturbances of any program on PyBullet, by the names of its bodies; only where it is installed."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from inspect import isbuiltin
from pathlib import Path
from random import Random
from typing import Any

import pytest

from mutabot_world.change import NotInWorldError, NumberChange

from .belts import project, run

pybullet = pytest.importorskip("pybullet")
KEPT = dict(vars(pybullet))
on_pybullet = pytest.importorskip("mutabot_world.pybullet")
HOOKED = dict(vars(pybullet))
vars(pybullet).update(KEPT)

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


@pytest.fixture(autouse=True)
def around_pybullet() -> Iterator[None]:
    """What disturbances put around functions of PyBullet is taken away after a test."""
    vars(pybullet).update(HOOKED)
    yield
    vars(pybullet).update(KEPT)
    on_pybullet._worlds.clear()
    for changes in on_pybullet._changes.values():
        changes.clear()


@pytest.fixture
def client() -> Iterator[int]:
    client = pybullet.connect(pybullet.DIRECT)
    yield client
    pybullet.disconnect(physicsClientId=client)


@pytest.fixture
def arm(client: int, tmp_path: Path) -> Any:
    (tmp_path / "arm.urdf").write_text(ARM)
    number = pybullet.loadURDF(
        str(tmp_path / "arm.urdf"),
        useFixedBase=True,
        flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
        physicsClientId=client,
    )
    return on_pybullet._worlds[client, number]


def disturb(body: Any, function: str, kind: str, amount: float, names: str = "*", **options: Any) -> None:
    getattr(on_pybullet, function)(body, NumberChange(kind, amount), names=names, random=Random(1), **options)


def test_mass_takes_inertia_along_also_where_the_program_says_it_anew(arm: Any) -> None:
    _, _, before = pybullet.getDynamicsInfo(arm.number, 0, physicsClientId=arm.client)[:3]
    disturb(arm, "mass", "scale", 1.0, "rod")
    mass, _, inertia = pybullet.getDynamicsInfo(arm.number, 0, physicsClientId=arm.client)[:3]
    assert (mass, *inertia) == pytest.approx((4.0, *(2 * value for value in before)))
    pybullet.changeDynamics(arm.number, 0, mass=3.0, physicsClientId=arm.client)
    assert pybullet.getDynamicsInfo(arm.number, 0, physicsClientId=arm.client)[0] == pytest.approx(6.0)


def test_friction_that_a_framework_sets_after_loading_is_disturbed(arm: Any) -> None:
    disturb(arm, "friction", "scale", -0.5)
    assert pybullet.getDynamicsInfo(arm.number, 0, physicsClientId=arm.client)[1] == pytest.approx(0.25)
    pybullet.changeDynamics(arm.number, 0, lateralFriction=1.0, physicsClientId=arm.client)
    assert pybullet.getDynamicsInfo(arm.number, 0, physicsClientId=arm.client)[1] == pytest.approx(0.5)


def test_a_position_is_off_also_after_a_reset(arm: Any) -> None:
    disturb(arm, "position", "offset", 0.1, "arm", axis="x")
    where = partial(pybullet.getBasePositionAndOrientation, arm.number, physicsClientId=arm.client)
    assert where()[0][0] == pytest.approx(0.1)
    pybullet.resetBasePositionAndOrientation(
        arm.number, (0.3, 0, 0), (0, 0, 0, 1), physicsClientId=arm.client
    )
    assert where()[0][0] == pytest.approx(0.4)


@pytest.mark.parametrize("many", [False, True])
def test_motors_of_the_joints_that_are_meant_are_weaker(arm: Any, many: bool) -> None:
    def angle() -> float:
        pybullet.resetJointState(arm.number, 0, 0.0, physicsClientId=arm.client)
        for _ in range(20):
            if many:
                pybullet.setJointMotorControlArray(
                    arm.number,
                    [0],
                    pybullet.POSITION_CONTROL,
                    [1.0],
                    forces=[5.0],
                    physicsClientId=arm.client,
                )
            else:
                pybullet.setJointMotorControl2(
                    arm.number, 0, pybullet.POSITION_CONTROL, 1.0, force=5.0, physicsClientId=arm.client
                )
            pybullet.stepSimulation(physicsClientId=arm.client)
        return float(pybullet.getJointState(arm.number, 0, physicsClientId=arm.client)[0])

    before = angle()
    disturb(arm, "strength", "scale", -0.5, "hinge")
    assert angle() == pytest.approx(before / 2, rel=0.1)


def test_gravity_that_the_program_sets_is_disturbed(client: int) -> None:
    pybullet.setGravity(0, 0, -10, physicsClientId=client)
    disturb(on_pybullet._worlds[client, "gravity"], "gravity", "scale", 0.1)
    assert pybullet.getPhysicsEngineParameters(client)["gravityAccelerationZ"] == pytest.approx(-11)


def test_a_body_that_has_the_number_of_one_before_is_another_one(arm: Any, tmp_path: Path) -> None:
    disturb(arm, "friction", "scale", -0.5)
    pybullet.resetSimulation(physicsClientId=arm.client)
    number = pybullet.loadURDF(str(tmp_path / "arm.urdf"), physicsClientId=arm.client)
    assert number == arm.number
    pybullet.changeDynamics(number, 0, lateralFriction=1.0, physicsClientId=arm.client)
    assert pybullet.getDynamicsInfo(number, 0, physicsClientId=arm.client)[1] == pytest.approx(1.0)


def test_clients_that_ask_for_built_in_functions_find_them() -> None:
    assert isbuiltin(pybullet.loadURDF)


def test_names_that_match_nothing_are_said(arm: Any) -> None:
    with pytest.raises(
        NotInWorldError, match="no joint is named 'wrist'; the last body has: hinge; bodies: arm"
    ):
        disturb(arm, "gain", "scale", 1.0, "wrist")


MISSION = """
    from pybullet import setGravity
    import pybullet

    def fallen(steps):
        client = pybullet.connect(pybullet.DIRECT)
        for _ in range(2):
            pybullet.resetSimulation(physicsClientId=client)
            setGravity(0, 0, -10, physicsClientId=client)
            cube = pybullet.createMultiBody(1.0, physicsClientId=client)
            for _ in range(steps):
                pybullet.stepSimulation(physicsClientId=client)
            height = pybullet.getBasePositionAndOrientation(cube, physicsClientId=client)[0][2]
        pybullet.disconnect(client)
        return -height
    """
BELOW = """
    import subprocess
    import sys

    def fallen(steps):
        code = f"import falling; print(falling.fallen({steps}))"
        words = [sys.executable, "-c", code]
        return float(subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()[-1])
    """


@pytest.mark.parametrize(
    ("engine", "files"),
    [
        ("fork", {"mission.py": MISSION}),
        pytest.param("replay", {"mission.py": MISSION}, marks=pytest.mark.whole),
        pytest.param("replay", {"mission.py": BELOW, "falling.py": MISSION}, marks=pytest.mark.whole),
    ],
)
def test_a_test_notices_a_cube_that_falls_faster(engine: str, files: dict[str, str], tmp_path: Path) -> None:
    checks = """
        import mission

        def test_it_falls():
            assert 1.21 < mission.fallen(120) < 1.27
        """
    table = """
        parameters = ["mutabot_world:pybullet.toml"]
        only = ["gravity", "mass"]
        names = { mass = "cup" }
        """
    folder = project(tmp_path, table, **{"belt.toml": "", "tests/test_mission.py": checks, **files})
    text = (folder / "pyproject.toml").read_text().replace('of = ["belt:Belt"]\n', "")
    names = ", ".join(f'"{name}"' for name in files)
    (folder / "pyproject.toml").write_text(text.replace('"mission.py"', names))
    found = run(folder, "--engine", engine, "-o", "rounds=1")
    assert found["gravity +"]["noticed_from"] == 5
    assert "no body or link is named 'cup'; the last body has: body 0" in found["mass +"]["sentence"]
