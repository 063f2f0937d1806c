def test_heading(agv):
    assert agv.heading == 180
