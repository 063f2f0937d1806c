def test_latched(agv):
    assert agv.latched


def test_position(agv):
    assert abs(agv.way - 2.5) < 1e-6
