import mission


def test_pick(arm):
    mission.pick(arm)


def test_angle(arm):
    assert arm.angle < 180.0
