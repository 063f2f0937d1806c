import numpy as np
import pytest
from arm import Arm

from draw import draw


def test_the_line_ends_where_it_should():
    arm = Arm()
    draw(arm, np.array([0.3, 0.2]), np.array([0.5, 0.2]))
    assert arm.drawn[0] == pytest.approx([0.3, 0.2], abs=0.002)
    assert arm.drawn[-1] == pytest.approx([0.5, 0.2], abs=0.002)
