"""The cell, and what mutabot is told of it while it records."""

import numpy as np
import pybullet as p
import pybullet_data
import pytest

from mutabot.api.processes import Feed

HAND, FINGER = 11, 9


def pose(place, turned):
    """As mutabot wants it: PyBullet's quaternions end with w."""
    return (*place, turned[3], *turned[:3])


def picture():
    view = p.computeViewMatrixFromYawPitchRoll([0.35, 0.0, 0.2], 1.4, 55, -30, 0, 2)
    lens = p.computeProjectionMatrixFOV(50, 4 / 3, 0.1, 5)
    width, height, pixels, *_ = p.getCameraImage(480, 360, view, lens, renderer=p.ER_TINY_RENDERER)
    return np.reshape(pixels, (height, width, 4)).astype(np.uint8)


@pytest.fixture
def cell(monkeypatch):
    client = p.connect(p.DIRECT)
    p.setAdditionalSearchPath(pybullet_data.getDataPath())
    p.setGravity(0, 0, -9.81)
    floor = p.loadURDF("plane.urdf")
    robot = p.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
    for joint, angle in enumerate([0, -0.3, 0, -2.2, 0, 2.0, 0.8]):
        p.resetJointState(robot, joint, angle)
    cube = p.loadURDF("cube_small.urdf", [0.5, 0.1, 0.025])

    names, steps, step = {floor: "floor", robot: "robot"}, [0], p.stepSimulation
    feed = Feed(lambda: steps[0] / 240)
    feed.pose("tool", lambda: pose(*p.getLinkState(robot, HAND)[4:6]))
    feed.pose("cube", lambda: pose(*p.getBasePositionAndOrientation(cube)), size=(0.05, 0.05, 0.05))
    feed.value("finger", lambda: p.getJointState(robot, FINGER)[0], unit="m")
    feed.contacts(lambda: {("cube", names[contact[2]]) for contact in p.getContactPoints(cube)})
    feed.camera(picture, rate=10)

    def step_and_tell():
        step()
        steps[0] += 1
        feed.tick()

    monkeypatch.setattr(p, "stepSimulation", step_and_tell)
    yield robot, cube
    p.disconnect(client)
