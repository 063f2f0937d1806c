from unittest.mock import Mock, patch

import mission
import pytest
from robot import Cart


@pytest.fixture
def cart():
    return Cart()


def test_drives_half_the_way_back(cart):
    watched = Mock(wraps=cart)
    mission.deliver(watched, 2.0)
    assert watched.drive.call_count == 2
    assert cart.x == 1.0


def test_beeps_far_out(cart):
    with patch.object(cart, "beep", wraps=cart.beep) as beep:
        mission.deliver(cart, 1.5)
    beep.assert_called_once_with()
    assert cart.beeps == 1


def test_is_silent_nearby(cart, monkeypatch):
    monkeypatch.setattr(cart, "drive", lambda distance, speed=1.0: setattr(cart, "x", cart.x + distance / 2))
    mission.deliver(cart, 1.5)
    assert cart.beeps == 0


def test_stops_where_it_is_told_so():
    with patch.object(Cart, "drive", autospec=True, side_effect=[None, ValueError("blocked")]) as drive:
        with pytest.raises(ValueError, match="blocked"):
            mission.deliver(Cart(), 0.5)
    assert drive.call_args.kwargs == {"distance": -0.25, "speed": 0.5}
