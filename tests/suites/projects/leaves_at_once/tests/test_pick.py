import mission


def test_pick(arm):
    mission.pick(arm)
    assert arm.z < 0.5
