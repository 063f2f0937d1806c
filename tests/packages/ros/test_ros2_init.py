"""``mutabot init`` on a node of ROS 2: operations by name, and none of them as a call of rclpy."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot_init.propose import propose

pytest.importorskip("rclpy", reason="no ROS 2 in this environment (requirements-ros2.lock)")

MISSION = """
    import time

    import rclpy
    from geometry_msgs.msg import PoseStamped
    from rclpy.node import Node
    from std_msgs.msg import Float64
    from std_srvs.srv import SetBool

    class Mission(Node):
        def __init__(self):
            super().__init__("mission")
            self.declare_parameter("step", 0.25)
            self.gaps = []
            self.goals = self.create_publisher(PoseStamped, "goal", 10)
            self.closing = self.create_client(SetBool, "/gripper/close")
            self.create_subscription(Float64, "/sensor/distance", self.on_gap, 10)
            self.create_timer(0.01, self.on_time)
            self.ticks = 0

        def on_gap(self, message):
            self.gaps.append(message.data)

        def on_time(self):
            self.ticks += 1
            goal = PoseStamped()
            goal.header.frame_id = "base"
            goal.pose.position.y = self.get_parameter("step").value
            self.goals.publish(goal)

        def run(self, spin):
            spin(self.closing.service_is_ready)
            answer = self.closing.call_async(SetBool.Request(data=True))
            spin(answer.done)
            spin(lambda: self.gaps and self.ticks)
            return answer.result().success
"""
TESTS = """
    import time

    import pytest
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node
    from std_msgs.msg import Float64
    from std_srvs.srv import SetBool

    from mission import Mission

    @pytest.fixture
    def spin():
        rclpy.init()
        robot = Node("robot")
        gap = robot.create_publisher(Float64, "/sensor/distance", 10)
        robot.create_timer(0.01, lambda: gap.publish(Float64(data=0.5)))

        def close(request, response):
            response.success = True
            return response

        robot.create_service(SetBool, "/gripper/close", close)
        executor = SingleThreadedExecutor()
        executor.add_node(robot)

        def spin_until(done):
            end = time.monotonic() + 60.0
            while not done():
                assert time.monotonic() < end
                executor.spin_once(0.01)

        spin_until.executor = executor
        yield spin_until
        rclpy.shutdown()

    def test_it_closes(spin):
        mission = Mission()
        spin.executor.add_node(mission)
        assert mission.run(spin)
"""


def test_what_a_node_of_ros_2_does_is_proposed_by_name(tmp_path: Path) -> None:
    for name, text in {"mission.py": MISSION, "tests/test_it.py": TESTS}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(textwrap.dedent(text))
    told = "\n".join(propose(tmp_path, [Path("mission.py")]))
    text = (tmp_path / "robot.toml").read_text(encoding="utf-8")
    assert "1 passed" in told, told
    found = {
        operation.target: operation for operation in load_vocabulary(["robot.toml"], tmp_path).operations
    }
    assert {target: value.named.type for target, value in found.items() if value.named is not None} == {
        "parameter step": None,
        "tick Mission.on_time": None,
        "timer Mission.on_time": None,
        "receive /sensor/distance": "std_msgs/Float64",
        "subscribe /sensor/distance": "std_msgs/Float64",
        "publish /goal": "geometry_msgs/PoseStamped",
        "advertise /goal": "geometry_msgs/PoseStamped",
        "call /gripper/close": "std_srvs/SetBool",
        "client /gripper/close": "std_srvs/SetBool",
    }
    goal = {argument.name: argument for argument in found["publish /goal"].arguments}
    y = goal["pose.position.y"]
    assert (y.kind, y.axis, y.unit, y.mode, y.frame) == ("translation", "y", "m", "to", "base")
    assert goal["pose.orientation"].kind == "quaternion"
    (distance,) = found["receive /sensor/distance"].result
    assert (distance.kind, distance.unit) == ("distance", "m")
    (closed,) = (argument for argument in found["call /gripper/close"].arguments if argument.name == "data")
    assert (closed.kind, closed.values) == ("opening", (False, True))
    assert "rclpy" not in text
