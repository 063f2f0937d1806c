import unittest

import mission
import pytest
from robot import Belt, Scale


@pytest.fixture
def cell():
    belt = Belt()
    return belt, mission.weigh_in(Scale(belt), belt)


def test_by_fail(cell):
    if cell[0].at != 1.0:
        pytest.fail("the belt is elsewhere")


def test_by_raise(cell):
    if cell[0].colour == "red":
        raise ValueError("rejected")


def test_by_warning(cell):
    with pytest.warns(UserWarning, match="heavy"):
        import warnings

        if cell[1] > 10:
            warnings.warn("heavy", stacklevel=1)


def test_by_exit_of_the_test(cell):
    if cell[1] < -5:
        raise SystemExit("scale is broken")


class Numbers(unittest.TestCase):
    def test_almost(self):
        belt = Belt()
        self.assertAlmostEqual(mission.weigh_in(Scale(belt), belt), 12.5)
