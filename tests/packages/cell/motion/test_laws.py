"""A time law is found for every length, also where two kinds of laws meet."""

from __future__ import annotations

import numpy as np
import pytest
import ruckig

from mutabot_cell.motion.trajectory import time_law


@pytest.mark.parametrize(("speed", "acceleration", "jerk"), [(0.52, 1.0, 10.0), (0.55, 2.0, 20.0)])
def test_a_law_is_found_where_the_limit_of_acceleration_is_just_reached(
    speed: float, acceleration: float, jerk: float
) -> None:
    """From rest to rest without a time of even acceleration: 2 a³/j², and a few roundings beside it."""
    critical = 2 * acceleration**3 / jerk**2
    duration = 4 * acceleration / jerk
    for roundings in range(-300, 300):
        length = critical * (1 + roundings * 2.0**-53)
        request = ruckig.InputParameter(1)
        request.max_velocity, request.target_position = [speed / length], [1.0]
        request.max_acceleration, request.max_jerk = [acceleration / length], [jerk / length]
        trajectory = time_law(ruckig.Ruckig(1), request)
        assert trajectory.duration == pytest.approx(duration, rel=1e-3)
        positions, speeds = np.array(trajectory.at_time(duration / 2)[:2]).ravel()
        assert (positions, speeds * length) == pytest.approx((0.5, acceleration**2 / jerk), rel=2e-3)
