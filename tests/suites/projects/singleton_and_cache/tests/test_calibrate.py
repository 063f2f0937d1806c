import mission
from robot import Link, connect


def test_calibrate():
    assert mission.calibrate() is not None


def test_offset():
    assert connect().offset == 0.02


def test_log_is_kept():
    assert Link().log[-1] == -0.01
