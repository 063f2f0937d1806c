"""``mutabot init`` on a node of ROS 1: operations by name, and none of them as a call of rospy."""

from __future__ import annotations

import textwrap
from pathlib import Path

from mutabot.config.vocabulary import load_vocabulary
from mutabot_init.propose import propose

from .both import needs_ros1

DRIVER = """
    import rospy
    from geometry_msgs.msg import PointStamped
    from std_srvs.srv import SetBool

    rospy.init_node("driver")
    pose = rospy.Publisher("/arm/pose", PointStamped, queue_size=10, latch=True)
    message = PointStamped()
    message.header.frame_id = "base"
    message.point.y = 0.5
    pose.publish(message)
    rospy.Service("/gripper/close", SetBool, lambda request: (True, ""))
    rospy.Subscriber("/arm/move_by", rospy.AnyMsg, lambda message: None)
    rospy.spin()
"""
ROBOT = """
    import rospy
    from std_srvs.srv import SetBool

    class Gripper:
        def __init__(self):
            self.proxy = rospy.ServiceProxy("/gripper/close", SetBool)

        def close(self, closed):
            return self.proxy(closed)
"""
MISSION = """
    import rospy
    from geometry_msgs.msg import PointStamped, Twist

    from robot import Gripper

    poses = []

    class Mission:
        def __init__(self):
            self.step = rospy.get_param("~step", 0.25)
            self.moves = rospy.Publisher("/arm/move_by", Twist, queue_size=1)
            self.gripper = Gripper()
            self.ticked = False
            self.timer = rospy.Timer(rospy.Duration(0.01), self.on_time)

        def on_time(self, event):
            self.ticked = True

        def run(self):
            rate = rospy.Rate(100)
            while not poses or not self.ticked or not self.moves.get_num_connections():
                rate.sleep()
            move = Twist()
            move.linear.y = self.step
            self.moves.publish(move)
            rospy.wait_for_service("/gripper/close")
            self.gripper.close(True)
            self.timer.shutdown()

    def on_pose(message):
        poses.append(message.point.y)

    def main():
        rospy.init_node("mission")
        rospy.Subscriber("/arm/pose", PointStamped, on_pose)
        Mission().run()

    main()
"""
TESTS = """
    import subprocess
    import sys

    def test_the_mission_ends():
        driver = subprocess.Popen([sys.executable, "driver.py"])
        try:
            subprocess.run([sys.executable, "mission.py"], timeout=30, check=True)
        finally:
            driver.kill()
            driver.wait()
"""


@needs_ros1
def test_what_a_node_of_ros_1_does_is_proposed_by_name(tmp_path: Path) -> None:
    files = {"driver.py": DRIVER, "robot.py": ROBOT, "mission.py": MISSION, "tests/test_it.py": TESTS}
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(textwrap.dedent(text))
    told = "\n".join(propose(tmp_path, [Path("mission.py")]))
    text = (tmp_path / "robot.toml").read_text(encoding="utf-8")
    assert "1 passed" in told, told
    found = {
        operation.target: operation for operation in load_vocabulary(["robot.toml"], tmp_path).operations
    }
    assert {target: value.named.type for target, value in found.items() if value.named is not None} == {
        "parameter /mission/step": None,
        "tick Mission.on_time": None,
        "timer Mission.on_time": None,
        "sleep /mission": None,
        "rate /mission": None,
        "receive /arm/pose": "geometry_msgs/PointStamped",
        "subscribe /arm/pose": "geometry_msgs/PointStamped",
        "publish /arm/move_by": "geometry_msgs/Twist",
        "advertise /arm/move_by": "geometry_msgs/Twist",
        "call /gripper/close": "std_srvs/SetBool",
        "client /gripper/close": "std_srvs/SetBool",
    }
    assert len(found) == 11
    y = next(argument for argument in found["publish /arm/move_by"].arguments if argument.name == "linear.y")
    assert (y.kind, y.axis, y.unit, y.mode) == ("translation", "y", "m", "by")
    pose = {quantity.name: quantity for quantity in found["receive /arm/pose"].result}
    assert (pose["point.y"].kind, pose["point.y"].frame) == ("position", "base")
    assert "# value  # seen: 0.25" in text
    assert "rospy" not in text
    assert "no test reaches" not in text
