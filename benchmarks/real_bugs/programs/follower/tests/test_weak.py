"""The base moves."""

from scene import Scene


def test_it_drives_to_a_person():
    with Scene() as scene:
        assert scene.follow()
        scene.see(3.0, 0.5)
        assert any(forward or turn for forward, turn in scene.speeds)


def test_it_says_what_it_does():
    with Scene() as scene:
        scene.listen()
        scene.follow()
        scene.see(2.0, 0.0)
        assert scene.states
