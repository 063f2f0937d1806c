"""Distances, limits, old readings, and who hears of it."""

import pytest
from scene import Scene


def test_near_the_distance_it_slows_down():
    with Scene() as scene:
        scene.follow()
        scene.see(1.25, 0.0)
        assert scene.speeds[-1][0] == pytest.approx(0.2)


def test_too_near_it_backs_off():
    with Scene() as scene:
        scene.follow()
        scene.see(0.75, 0.0)
        assert scene.speeds[-1][0] == pytest.approx(-0.2)


def test_another_distance_and_speed_are_kept():
    with Scene(distance=2.0, top_speed=0.25) as scene:
        scene.follow()
        scene.see(2.25, 0.0)
        assert scene.speeds[-1][0] == pytest.approx(0.2)
        scene.see(4.0, 0.0)
        assert scene.speeds[-1][0] == 0.25


def test_it_turns_on_the_spot_to_who_is_beside_it_no_faster_than_allowed():
    with Scene() as scene:
        scene.follow()
        scene.see(0.5, 2.0)
        assert scene.speeds[-1] == (0.0, 1.0)


def test_a_person_who_is_gone_is_not_followed():
    with Scene() as scene:
        scene.follow()
        scene.see(5.0, 0.0)
        scene.spin(1.0)
        assert scene.speeds[-1] == (0.0, 0.0)


def test_what_comes_late_is_too_old():
    with Scene() as scene:
        scene.follow()
        scene.see(5.0, 0.0, late=0.75)
        assert scene.speeds[-1] == (0.0, 0.0)


def test_a_place_in_another_frame_is_none():
    with Scene() as scene:
        scene.follow()
        scene.see(5.0, 0.0, frame="map")
        assert scene.speeds[-1] == (0.0, 0.0)


def test_each_state_is_told_once():
    with Scene() as scene:
        scene.listen()
        scene.follow()
        scene.spin(0.3)
        scene.see(2.0, 0.0)
        scene.spin(1.0)
        scene.follow(False)
        scene.spin(0.2)
        assert scene.states == ["idle", "lost", "following", "lost", "idle"]


def test_who_listens_late_hears_the_last_state():
    with Scene() as scene:
        scene.follow()
        scene.see(2.0, 0.0)
        scene.listen()
        assert scene.states[0] == "following"


def test_a_new_start_waits_for_a_new_place():
    with Scene() as scene:
        scene.follow()
        scene.see(5.0, 0.0, seconds=0.1)
        scene.follow(False)
        scene.follow()
        scene.spin(0.2)
        assert scene.speeds[-1] == (0.0, 0.0)
