import mission
from robot import Axis


def setup_module():
    mission.CALIBRATION.unlink(missing_ok=True)


def teardown_module():
    mission.CALIBRATION.unlink()


def test_calibrate():
    mission.calibrate(Axis())
    assert mission.CALIBRATION.exists()


def test_range():
    assert mission.range_of_motion() == 10.0
