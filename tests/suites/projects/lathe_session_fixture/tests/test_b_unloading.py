import mission


def test_unload(robot):
    mission.unload_part(robot)
    assert not robot.gripped


def test_robot_is_back(robot):
    assert abs(robot.x) < 0.01
