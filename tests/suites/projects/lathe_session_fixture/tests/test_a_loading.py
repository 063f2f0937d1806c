import mission


def test_load(robot):
    mission.load_part(robot)


def test_part_is_held(robot):
    assert robot.gripped


def test_part_is_at_the_chuck(robot):
    assert abs(robot.part_at - 0.25) < 0.01
