"""The base goes where the person is, and stops."""

from scene import Scene


def test_far_ahead_it_drives_at_top_speed():
    with Scene() as scene:
        scene.follow()
        scene.see(5.0, 0.0)
        assert scene.speeds[-1] == (0.5, 0.0)


def test_it_turns_to_the_side_of_the_person():
    with Scene() as scene:
        scene.follow()
        scene.see(2.0, 0.5)
        assert scene.speeds[-1][1] > 0.2
        scene.see(2.0, -0.5)
        assert scene.speeds[-1][1] < -0.2


def test_it_stands_when_it_is_told_to():
    with Scene() as scene:
        scene.follow()
        scene.see(5.0, 0.0)
        scene.follow(False)
        scene.see(5.0, 0.0)
        assert scene.speeds[-1] == (0.0, 0.0)


def test_without_a_request_it_stands():
    with Scene() as scene:
        scene.see(5.0, 0.0)
        assert scene.speeds == []
