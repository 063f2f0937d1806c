"""How fast it may go."""

from scene import Scene


def test_alone_it_goes_at_full_speed():
    with Scene() as scene:
        scene.scan(5.0)
        assert scene.limits == [100.0]


def test_somebody_not_far_away_makes_it_slow():
    with Scene() as scene:
        scene.scan(1.0)
        assert scene.limits[-1] == 25.0
        assert not scene.stops[-1]


def test_a_stop_is_a_limit_of_nothing():
    with Scene() as scene:
        scene.scan(5.0, 0.25)
        assert scene.limits[-1] == 0.0


def test_after_a_reset_it_goes_on():
    with Scene() as scene:
        scene.scan(0.25, 5.0)
        assert scene.reset()
        scene.scan(5.0)
        assert scene.limits[-1] == 100.0
        assert not scene.stops[-1]
