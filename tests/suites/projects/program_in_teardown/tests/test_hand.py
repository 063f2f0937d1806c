"""The program is also used to tidy up, and the next test relies on it."""

import mission
import pytest
from robot import Hand

HANDS = []


@pytest.fixture(scope="module")
def hand():
    HANDS.append(Hand())
    return HANDS[-1]


@pytest.fixture
def grabbed(hand, request):
    mission.grab(hand)
    request.addfinalizer(lambda: mission.let_go(hand))
    return hand


def test_grabbed(grabbed):
    assert grabbed.closed


def test_tidy(hand):
    assert not hand.closed


def test_grabbed_again(grabbed):
    assert grabbed.at == pytest.approx(0.2)


def test_where_it_is_now(hand):
    assert hand.at == pytest.approx(0.0)
