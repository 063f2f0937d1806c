import pybullet as p
import pybullet_data
import pytest

import pick


@pytest.fixture
def cell():
    client = p.connect(p.DIRECT)
    p.setAdditionalSearchPath(pybullet_data.getDataPath())
    p.setGravity(0, 0, -9.81)
    p.loadURDF("plane.urdf")
    robot = p.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
    for joint, angle in enumerate([0, -0.3, 0, -2.2, 0, 2.0, 0.8]):
        p.resetJointState(robot, joint, angle)
    cube = p.loadURDF("cube_small.urdf", [0.5, 0.1, 0.025])
    yield robot, cube
    p.disconnect(client)


def test_the_cube_ends_at_the_goal(cell):
    robot, cube = cell
    pick.settle(20)
    pick.pick_and_place(robot, cube, (0.4, -0.3))
    (x, y, z), _ = p.getBasePositionAndOrientation(cube)
    assert abs(x - 0.4) < 0.03
    assert abs(y + 0.3) < 0.03
    assert z < 0.05
