"""It takes a tray."""

from scene import Scene


def test_it_takes_a_tray():
    with Scene() as scene:
        assert scene.ask("take")
        scene.spin(2.0)
        assert scene.program.state == "holding"


def test_it_reports():
    with Scene() as scene:
        scene.listen()
        scene.ask("take")
        scene.spin(2.0)
        assert scene.reports
