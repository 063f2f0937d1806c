"""It stops."""

from scene import Scene


def test_somebody_near_stops_it():
    with Scene() as scene:
        scene.scan(0.2)
        assert scene.stops[-1]


def test_nobody_stops_nothing():
    with Scene() as scene:
        scene.scan(5.0)
        assert not scene.stops[-1]
