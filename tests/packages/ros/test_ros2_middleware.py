"""A campaign of the family ``middleware`` on a node of ROS 2 in a process of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaign.project import write_project

from .both import CONFIGURATION, check_faults_of_the_middleware, needs_ros2

MISSION = '''
    """Sends four targets, one after the other: the next one when the last is reached."""

    import sys
    import time

    import rclpy
    from geometry_msgs.msg import PointStamped
    from rclpy.node import Node
    from std_msgs.msg import Float64
    from std_srvs.srv import Trigger


    class Mission(Node):
        def __init__(self):
            super().__init__("mission")
            self.declare_parameter("step", 0.5)
            self.step = self.get_parameter("step").value
            self.reached = False
            self.create_subscription(Float64, "gap", self.on_gap, 10)
            self.target = self.create_publisher(PointStamped, "target", 10)
            self.ready = self.create_client(Trigger, "ready")

        def on_gap(self, message):
            if message.data < 0.01:
                self.reached = True

        def until(self, done, seconds):
            end = time.monotonic() + seconds
            while not done() and time.monotonic() < end:
                rclpy.spin_once(self, timeout_sec=0.01)
            return done()

        def run(self):
            if not self.until(lambda: self.count_subscribers("target") and self.count_publishers("gap"), 5.0):
                return "nobody listens"
            if not self.ready.wait_for_service(1.0):
                return "nobody says that the arm is ready"
            answer = self.ready.call_async(Trigger.Request())
            if not self.until(answer.done, 1.0) or not answer.result().success:
                return "the arm is not ready"
            for number in range(4):
                message = PointStamped()
                message.header.frame_id = "base"
                message.header.stamp = self.get_clock().now().to_msg()
                message.point.x = self.step * (number + 1)
                self.reached = False
                self.target.publish(message)
                if not self.until(lambda: self.reached, 1.0):
                    return f"target {number} is not reached"
            return None


    def main():
        rclpy.init()
        mission = Mission()
        ended = mission.run()
        mission.destroy_node()
        rclpy.shutdown()
        sys.exit(ended)


    if __name__ == "__main__":
        main()
'''
TESTS = """
    import subprocess
    import sys
    from threading import Thread

    import pytest
    import rclpy
    from geometry_msgs.msg import PointStamped
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from std_msgs.msg import Float64
    from std_srvs.srv import Trigger


    @pytest.fixture(scope="session")
    def node():
        rclpy.init()
        node = rclpy.create_node("tests")
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        thread = Thread(target=executor.spin)
        thread.start()
        yield node
        executor.shutdown()
        thread.join()
        rclpy.shutdown()


    def test_all_targets_are_reached_in_order(node):
        got = []
        gap = node.create_publisher(Float64, "gap", 10)

        def move(message):
            got.append(message)
            gap.publish(Float64(data=1.0))
            gap.publish(Float64(data=0.001))

        def ready(request, response):
            response.success = True
            return response

        node.create_subscription(PointStamped, "target", move, 10)
        node.create_service(Trigger, "ready", ready)
        command = [sys.executable, "mission.py", "--ros-args", "-p", "step:=0.25"]
        mission = subprocess.run(command, timeout=20, check=False)
        assert mission.returncode == 0
        assert [one.point.x for one in got] == [0.25, 0.5, 0.75, 1.0]
        assert {one.header.frame_id for one in got} == {"base"}
"""
VOCABULARY = """
    [[operation]]
    topic = "/target"
    direction = "publish"
    type = "geometry_msgs/PointStamped"
    fields."header.frame_id" = { kind = "frame_id", values = ["base", "tool"] }
    fields."header.stamp" = { kind = "stamp" }

    [[operation]]
    topic = "/gap"
    direction = "receive"
    type = "std_msgs/Float64"

    [[operation]]
    service = "/ready"

    [[operation]]
    parameter = "step"
"""
#: what becomes of each, and what of its kill says why
WANTED = {
    "self.get_parameter#1:value:use-default": ("killed", "[0.5, 1.0, 1.5, 2.0]"),
    "self.create_publisher#1:reliability:wrong-reliability": ("killed", "assert 1 == 0"),
    "self.ready.call_async#1:call:lose-answer": ("killed", "assert 1 == 0"),
    "self.target.publish#1:call:stale=previous": ("killed", "[0.25, 0.25, 0.5, 0.75]"),
    "self.target.publish#1:call:kill-node": ("killed", "assert -9 == 0"),
    "def on_gap#1:call:delay=0.1": ("survived", ""),
    "def on_gap#1:call:restart-node": ("killed", "[0.25, 0.25, 0.5, 0.75, 1.0]"),
}


@needs_ros2
@pytest.mark.whole
def test_faults_of_the_middleware_act_in_the_node_and_the_suite_notices_those_it_checks(
    tmp_path: Path,
) -> None:
    write_project(tmp_path, MISSION, TESTS, vocabulary=VOCABULARY, configuration=CONFIGURATION)
    check_faults_of_the_middleware(tmp_path, WANTED, engine="replay")
