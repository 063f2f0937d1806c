import mission
import numpy as np
from robot import Arm, Camera


def test_readings_differ_by_a_step():
    arm = Arm()
    seen = mission.inspect_grid(arm, Camera(arm))
    np.testing.assert_allclose(seen[0] - seen[1], [0.1, 0.0, 0.0], atol=1e-9)


def test_ends_at_the_start():
    arm = Arm()
    mission.inspect_grid(arm, Camera(arm))
    assert np.allclose(arm.pose[:2], [0.1, 0.2])
    assert len(arm.path) == 3
