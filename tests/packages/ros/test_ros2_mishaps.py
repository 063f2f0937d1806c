"""What goes wrong around a node of ROS 2 while its mutants run is told as what it is, and is no kill."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import write_project

from .both import (
    CONFIGURATION,
    End,
    check_that_a_driver_that_does_not_come_up_kills_no_mutant,
    check_that_a_node_killed_from_outside_kills_no_mutant,
    end_with_driver,
    needs_ros2,
)

pytestmark = needs_ros2

#: it calls its arm many times more than the queue holds, before the one target that counts
MISSION = """
    import sys
    import time

    import rclpy
    from geometry_msgs.msg import Point
    from std_msgs.msg import Float64

    rclpy.init()
    node = rclpy.create_node("mission")
    reached = []
    node.create_subscription(Float64, "/reached", lambda message: reached.append(message.data), 1)
    target = node.create_publisher(Point, "/target", 1)

    def until(done, seconds):
        end = time.monotonic() + seconds
        while not done() and time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=0.01)
        return done()

    if not until(lambda: target.get_subscription_count() and node.count_publishers("/reached"), 5.0):
        sys.exit("no driver has subscribed")
    for number in range(100):
        target.publish(Point(x=0.25, y=0.001 * number))
    target.publish(Point(x=0.5, y=1.0))
    sys.exit(0 if until(lambda: 0.5 in reached, 3.0) else "not there")
"""
DRIVER = """
    import os
    import sys
    import time
    from pathlib import Path

    import rclpy
    from geometry_msgs.msg import Point
    from std_msgs.msg import Float64

    starts = Path(os.environ["STARTS"])
    with starts.open("a") as file:
        file.write("x")
    if len(starts.read_text()) > int(os.environ["LIMIT"]):
        sys.exit("the arm has no power")
    rclpy.init()
    node = rclpy.create_node("driver")
    reached = node.create_publisher(Float64, "/reached", 1)

    def on_target(message):
        if message.x < -0.4 and "VICTIM" in os.environ:
            Path(os.environ["VICTIM"]).write_text(str(os.getpid()))
            time.sleep(10)
        time.sleep(0.002)
        reached.publish(Float64(data=message.x))

    node.create_subscription(Point, "/target", on_target, 1)
    rclpy.spin(node)
"""
TESTS = """
    import subprocess
    import sys

    import pytest

    @pytest.fixture(params=[{drivers}])
    def drivers(request):
        started = [subprocess.Popen([sys.executable, "driver.py"]) for _ in range(request.param)]
        yield started
        for one in started:
            one.kill()
            one.wait()

    def test_the_target_is_reached(drivers):
        mission = subprocess.run([sys.executable, "mission.py"], timeout=20, check=False)
        assert mission.returncode == 0
"""
VOCABULARY = """
    [[operation]]
    topic = "/target"
    direction = "publish"
    type = "geometry_msgs/Point"
    fields.x = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    fields.y = { kind = "translation", axis = "y", unit = "m", mode = "by" }

    [[operation]]
    topic = "/nothing"
    direction = "receive"
    type = "std_msgs/Float64"
    fields.data = { kind = "position", axis = "x", unit = "m", noise = 0.1 }
"""
#: the target that counts, in the direction that is looked at, and in one that nobody looks at
LOOKED_AT, IGNORED = "*target.publish#2:x:reverse", "*target.publish#2:y:reverse"


@pytest.fixture
def end_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., End]:
    """How a mutant ends where so many drivers are started."""

    def write(mutant: str, drivers: int = 1) -> End:
        tests = TESTS.format(drivers=drivers)
        more = {"driver.py": DRIVER}
        write_project(tmp_path, MISSION, tests, vocabulary=VOCABULARY, configuration=CONFIGURATION, more=more)
        return partial(end_with_driver, tmp_path, monkeypatch, mutant, engine="replay")

    return write


@pytest.mark.whole
def test_a_node_that_is_killed_from_outside_kills_no_mutant(end_of: Callable[..., End]) -> None:
    check_that_a_node_killed_from_outside_kills_no_mutant(end_of(LOOKED_AT))


@pytest.mark.whole
def test_a_driver_that_does_not_come_up_kills_no_mutant(end_of: Callable[..., End]) -> None:
    check_that_a_driver_that_does_not_come_up_kills_no_mutant(end_of(LOOKED_AT))


@pytest.mark.whole
def test_a_full_queue_kills_no_mutant_and_a_topic_without_messages_is_reported(
    end_of: Callable[..., End],
) -> None:
    found, lines = end_of(IGNORED)(1000)
    assert (found.verdict, found.acted) == (Verdict.SURVIVED, 1)
    assert any("no test received anything on /nothing" in line for line in lines)


@pytest.mark.whole
def test_with_two_nodes_of_one_name_the_tests_judge_as_ever(end_of: Callable[..., End]) -> None:
    found, _ = end_of(IGNORED, drivers=2)(1000)
    assert (found.verdict, found.acted) == (Verdict.SURVIVED, 1)
