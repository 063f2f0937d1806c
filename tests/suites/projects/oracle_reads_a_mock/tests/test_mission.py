from unittest.mock import Mock

import mission
import pytest
from robot import Lift


@pytest.fixture
def lift():
    heights = []
    mock = Mock(spec=Lift)
    mock.raise_by.side_effect = heights.append
    mock.height.side_effect = lambda: sum(heights)
    return mock


def test_is_loaded(lift):
    assert mission.load(lift, 3) == pytest.approx(0.3)
    assert lift.height() == pytest.approx(0.3)


def test_counts_layers(lift):
    mission.load(lift, 2)
    assert lift.raise_by.call_count == 2 and lift.height() > -1


def test_stays_down(lift):
    mission.load(lift, 0)
    assert not lift.height()
