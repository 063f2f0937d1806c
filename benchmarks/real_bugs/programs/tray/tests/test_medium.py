"""What it does with trays, and without."""

from scene import Scene


def test_a_tray_is_counted():
    with Scene() as scene:
        scene.ask("take")
        scene.spin(2.0)
        scene.listen()
        assert scene.reports == [{"state": "holding", "taken": 1, "opening": 20.0}]


def test_a_tray_is_given_back():
    with Scene() as scene:
        scene.ask("take")
        scene.spin(2.0)
        assert scene.ask("give")
        assert scene.log[-2:] == [("opening", 100.0), ("motor", False)]


def test_without_a_tray_it_fails():
    with Scene(between=0.0) as scene:
        scene.ask("take")
        scene.spin(4.0)
        assert scene.program.state == "failed"


def test_without_a_motor_it_fails_at_once():
    with Scene(works=False) as scene:
        scene.ask("take")
        scene.spin(0.2)
        assert scene.program.state == "failed"
        assert scene.log == [("motor", True)]
