import mission


def test_undock_does_nothing_bad(fleet):
    mission.undock(fleet[0])
    assert not fleet[0].latched


def test_other_agv_has_not_moved(agv):
    assert agv.way == 0.0


def test_undocked_position(fleet):
    assert abs(fleet[0].way - 2.0) < 1e-6
