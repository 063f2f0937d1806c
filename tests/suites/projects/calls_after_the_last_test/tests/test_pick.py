import mission


def test_pick(arm):
    mission.pick(arm)


def test_height(arm):
    assert arm.z < 0.5
