"""Single scans, silence, the edges, and what a reset may not do."""

import math

from scene import Scene


def test_one_scan_alone_does_not_stop_it():
    with Scene() as scene:
        scene.scan(0.25, 5.0, 0.25, 5.0, times=1)
        assert True not in scene.stops


def test_two_scans_in_a_row_stop_it():
    with Scene() as scene:
        scene.scan(0.25, times=2)
        assert scene.stops[-1]


def test_it_stays_stopped_until_it_is_reset():
    with Scene() as scene:
        scene.scan(0.25, 5.0)
        assert scene.stops[-1]
        assert scene.limits[-1] == 0.0


def test_without_scans_it_stops():
    with Scene() as scene:
        scene.scan(5.0)
        scene.spin(0.7)
        assert scene.stops[-1]
        assert scene.limits[-1] == 0.0


def test_scans_that_come_keep_it_going():
    with Scene() as scene:
        scene.scan(5.0, times=12)
        assert True not in scene.stops


def test_it_is_not_reset_while_somebody_is_near():
    with Scene() as scene:
        scene.scan(0.25)
        assert not scene.reset()
        assert scene.stops[-1]


def test_a_reset_allows_little_at_first():
    with Scene() as scene:
        scene.scan(0.25, 5.0)
        scene.reset()
        assert scene.limits[-1] == 25.0


def test_only_its_width_is_watched():
    with Scene() as scene:
        scene.scan(0.25, at=75)
        scene.scan(0.25, at=-75)
        assert True not in scene.stops
        scene.scan(0.25, at=55)
        assert scene.stops[-1]


def test_another_width_is_watched_to_both_sides():
    for side in (85, -85):
        with Scene(width=180.0) as scene:
            scene.scan(0.25, at=side)
            assert scene.stops[-1]


def test_what_the_scanner_cannot_measure_is_nobody():
    with Scene() as scene:
        scene.scan(0.0, math.nan, math.inf)
        assert True not in scene.stops


def test_each_limit_is_told_once():
    with Scene() as scene:
        scene.scan(5.0, 1.0, 5.0)
        assert scene.limits == [100.0, 25.0, 100.0]


def test_each_stop_is_told_once():
    with Scene() as scene:
        scene.scan(0.25, times=5)
        assert scene.stops == [False, True]
