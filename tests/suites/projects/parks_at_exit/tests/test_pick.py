import mission


def test_pick():
    mission.pick()
    assert mission.ARM.z < 0.5
