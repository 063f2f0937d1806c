import asyncio

import mission
import pytest


@pytest.fixture
def arm():
    return mission.new_arm()


def test_go(arm):
    assert mission.go(arm) == 2.0
    assert arm.closed


def test_listen(arm):
    assert mission.listen(arm) > 0.0


def test_again(arm):
    assert mission.again(arm) == pytest.approx(0.125)


def test_handed(arm):
    assert mission.handed(arm) > 0.0


def test_follow(arm):
    assert mission.follow(arm) == 3.0


def test_beside(arm):
    assert mission.beside(arm) > 0.0


def test_scheduled(arm):
    assert asyncio.run(mission.scheduled(arm)) > 0.0


def test_awaited(arm):
    assert asyncio.run(mission.awaited(arm)) == 1.0
    assert arm.closed


def test_loop_in_callback(arm):
    assert mission.loop_in_callback(arm) == 5.0


def test_home(arm):
    assert mission.home(arm) == 0.0


def test_pick(arm):
    assert mission.pick(arm) > 0.5


def test_down(arm):
    assert mission.down(arm, 2) == 1.5
