from robot import connect


def test_position_after_calibration():
    assert connect().position == 0.01
