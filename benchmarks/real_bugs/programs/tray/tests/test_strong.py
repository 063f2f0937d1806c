"""In which order, how often, and what it refuses."""

from scene import Scene


def test_the_motor_is_on_before_the_fingers_close():
    with Scene() as scene:
        scene.ask("take")
        scene.spin(2.0)
        assert scene.log == [("motor", True), ("opening", 0.0)]


def test_it_tries_as_often_as_it_may_and_switches_off():
    with Scene(between=0.0, attempts=3) as scene:
        scene.ask("take")
        scene.spin(6.0)
        assert [command for command in scene.log if command == ("opening", 0.0)] == 3 * [("opening", 0.0)]
        assert scene.log[-2:] == [("opening", 100.0), ("motor", False)]


def test_it_gives_up_after_its_patience():
    with Scene(between=0.0, attempts=1) as scene:
        scene.ask("take")
        scene.spin(1.2)
        assert scene.program.state == "closing"
        scene.spin(0.6)
        assert scene.program.state == "failed"


def test_something_thicker_is_no_tray():
    with Scene(between=0.03, attempts=1) as scene:
        scene.ask("take")
        scene.spin(2.0)
        assert scene.program.state == "failed"


def test_fingers_that_move_hold_nothing():
    with Scene(between=0.0) as scene:
        scene.ask("take")
        scene.spin(1.0)
        assert scene.program.taken == 0


def test_joints_count_by_their_names():
    with Scene(order=("wrist", "right_finger", "left_finger")) as scene:
        scene.ask("take")
        scene.spin(2.0)
        scene.listen()
        assert scene.reports[-1] == {"state": "holding", "taken": 1, "opening": 20.0}


def test_joints_of_another_device_do_not_count():
    with Scene(order=("wrist",), attempts=1) as scene:
        scene.ask("take")
        scene.spin(2.0)
        assert scene.program.state == "failed"


def test_it_takes_no_second_tray():
    with Scene() as scene:
        scene.ask("take")
        assert not scene.ask("take")
        scene.spin(2.0)
        assert not scene.ask("take")
        assert scene.program.taken == 1


def test_it_gives_nothing_that_it_does_not_hold():
    with Scene() as scene:
        assert not scene.ask("give")
        assert scene.log == []


def test_after_a_failure_it_takes_one():
    with Scene(between=0.0, attempts=1) as scene:
        scene.ask("take")
        scene.spin(2.5)
        scene.between = 0.02
        assert scene.ask("take")
        scene.spin(2.0)
        assert scene.program.state == "holding"


def test_a_tray_that_is_held_is_held_on():
    with Scene() as scene:
        scene.ask("take")
        scene.spin(4.0)
        assert scene.program.state == "holding"
        assert scene.program.taken == 1
        assert scene.log[-1] == ("opening", 0.0)


def test_each_state_is_reported():
    with Scene() as scene:
        scene.listen()
        scene.ask("take")
        scene.spin(2.0)
        assert [report["state"] for report in scene.reports] == ["starting", "closing", "holding"]
