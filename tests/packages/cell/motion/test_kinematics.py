from __future__ import annotations

import math

import numpy as np
import pytest

from mutabot_cell import Cell
from mutabot_cell.geometry import (
    euler_from_rotation,
    rotation_about,
    rotation_from_euler,
    rotation_vector,
)
from mutabot_cell.models import kinova, robotiq
from mutabot_cell.motion.kinematics import STRAIGHTNESS, Kinematics
from mutabot_cell.motion.line import Line
from mutabot_cell.motion.reach import WristReach
from mutabot_cell.motion.trajectory import Spline


def chained_tool(joints: np.ndarray) -> np.ndarray:
    """The tool's transform, shape (4, 4), straight from the maker's table."""

    def step(origin: tuple[float, float, float], turn_x: float, turn_z: float = 0.0) -> np.ndarray:
        transform = np.eye(4)
        transform[:3, 3] = origin
        transform[:3, :3] = rotation_from_euler(math.degrees(turn_x), 0, 0) @ rotation_from_euler(
            0, 0, math.degrees(turn_z)
        )
        return transform

    result = np.eye(4)
    for joint, angle in zip(kinova.JOINTS, joints, strict=True):
        result = result @ step(joint.origin, joint.turn, angle)
    return result @ step(kinova.INTERFACE_OFFSET, math.pi) @ step((0, 0, robotiq.TOOL_LENGTH), 0)


def random_joints(generator: np.random.Generator) -> np.ndarray:
    limits = np.array([min(joint.limit, math.pi) for joint in kinova.JOINTS])
    return generator.uniform(-limits, limits)


def test_home_pose_is_the_one_the_real_robot_reports() -> None:
    pose = Cell(0).truth.tool_pose()
    assert math.dist((pose.x, pose.y, pose.z), (0.5767, 0.0014, 0.4337)) < 0.0005
    rotation = rotation_from_euler(pose.theta_x, pose.theta_y, pose.theta_z)
    away = rotation_vector(rotation_from_euler(90, 0, 90).T @ rotation)
    assert math.degrees(np.linalg.norm(away)) < 0.1


def test_forward_kinematics_follow_the_published_table() -> None:
    kinematics = Kinematics(kinova.gen3())
    generator = np.random.default_rng(7)
    for _ in range(20):
        joints = random_joints(generator)
        position, rotation = kinematics.tool(joints)
        expected = chained_tool(joints)
        np.testing.assert_allclose(position, expected[:3, 3], atol=1e-9)
        np.testing.assert_allclose(rotation, expected[:3, :3], atol=1e-9)


def test_tool_moves_as_finite_differences_of_the_joints_say() -> None:
    kinematics = Kinematics(kinova.gen3())
    generator = np.random.default_rng(8)
    small = 1e-6
    for _ in range(10):
        joints = random_joints(generator)
        change = generator.normal(size=7)
        start, rotation = kinematics.tool(joints)
        end, end_rotation = kinematics.tool(joints + small * change)
        exact, exact_rotation = chained_tool(joints), chained_tool(joints + small * change)
        np.testing.assert_allclose((end - start) / small, (exact_rotation - exact)[:3, 3] / small, atol=1e-4)
        turned = rotation_vector(rotation.T @ end_rotation) / small
        expected = rotation_vector(exact[:3, :3].T @ exact_rotation[:3, :3]) / small
        np.testing.assert_allclose(turned, expected, atol=1e-4)


def test_wrist_is_never_further_from_the_shoulder_than_the_reach() -> None:
    kinematics = Kinematics(kinova.gen3())
    generator = np.random.default_rng(9)
    reach = WristReach(kinova.gen3())
    farthest = max(reach.distance(*kinematics.tool(random_joints(generator))) for _ in range(200))
    assert farthest <= reach.length + 1e-3
    stretched = np.zeros(7)
    assert reach.distance(*kinematics.tool(stretched)) == pytest.approx(reach.length, abs=1e-3)


def test_euler_angles_survive_the_way_there_and_back() -> None:
    generator = np.random.default_rng(10)
    for _ in range(50):
        angles = generator.uniform((-179, -89, -179), (179, 89, 179))
        back = euler_from_rotation(rotation_from_euler(*angles))
        np.testing.assert_allclose(back, angles, atol=1e-9)


def test_euler_angles_at_gimbal_lock_give_the_same_rotation() -> None:
    for theta_y in (90.0, -90.0):
        rotation = rotation_from_euler(25.0, theta_y, 40.0)
        back = rotation_from_euler(*euler_from_rotation(rotation))
        np.testing.assert_allclose(back, rotation, atol=1e-9)


@pytest.mark.parametrize("angle", [0.0, 1e-10, 1e-3, 1.0, 3.0, math.pi])
def test_rotation_vectors_survive_the_way_there_and_back(angle: float) -> None:
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    rotation = rotation_about(angle * axis)
    np.testing.assert_allclose(rotation_about(rotation_vector(rotation)), rotation, atol=1e-7)


@pytest.mark.parametrize("change", [{"y": 0.2}, {"theta_x": 80.0}, {"z": -0.2}, {"theta_z": 60.0, "x": -0.1}])
def test_planned_tool_path_is_straight_between_the_knots_too(change: dict[str, float]) -> None:
    kinematics = Kinematics(kinova.gen3())
    home = np.array(kinova.HOME)
    start, rotation = kinematics.tool(home)
    shift = np.array([change.get(axis, 0.0) for axis in "xyz"])
    angles = np.array(euler_from_rotation(rotation))
    angles += [change.get(f"theta_{axis}", 0.0) for axis in "xyz"]
    line = Line.between(start, rotation, start + shift, rotation_from_euler(*angles))
    spline = Spline(kinematics.follow(home, line))
    for fraction in np.linspace(0, 1, 97).tolist():
        position, turned = kinematics.tool(spline.value(np.array([fraction]))[0])
        assert np.linalg.norm(position - line.position_at(fraction)) < STRAIGHTNESS
        assert np.linalg.norm(rotation_vector(turned.T @ line.rotation_at(fraction))) < 0.003
