import mission


def test_keeps_the_points():
    way, _ = mission.record([0.25, -0.5])
    assert way[0] == 0.25


def test_drops_the_last():
    way, _ = mission.record([0.25, -0.5])
    assert len(way) == 2
