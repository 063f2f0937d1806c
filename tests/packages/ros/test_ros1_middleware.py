"""A campaign of the family ``middleware`` on a node of ROS 1 in a process of its own, over a real master."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaign.project import write_project

from .both import CONFIGURATION, MASTER, check_faults_of_the_middleware, needs_ros1

MISSION = '''
    """Sends four targets, one after the other: the next one when the last is reached."""

    import sys
    from threading import Event

    import rospy
    from geometry_msgs.msg import PointStamped
    from std_msgs.msg import Float64

    reached = Event()


    def on_gap(message):
        if message.data < 0.01:
            reached.set()


    def main():
        rospy.init_node("mission", disable_rosout=True)
        step = rospy.get_param("/step", 0.5)
        rospy.Subscriber("/gap", Float64, on_gap, queue_size=10)
        target = rospy.Publisher("/target", PointStamped, queue_size=10, latch=True)
        while not target.get_num_connections():
            rospy.sleep(0.01)
        for number in range(4):
            message = PointStamped()
            message.header.frame_id = "base"
            message.header.stamp = rospy.Time.now()
            message.point.x = step * (number + 1)
            reached.clear()
            target.publish(message)
            if not reached.wait(1.0):
                sys.exit(f"target {number} is not reached")


    if __name__ == "__main__":
        main()
'''
TESTS = """
    import subprocess
    import sys

    import pytest
    import rospy
    from geometry_msgs.msg import PointStamped
    from std_msgs.msg import Float64

    @pytest.fixture(scope="session", autouse=True)
    def graph(master):
        rospy.init_node("tests", disable_rosout=True, disable_signals=True)
        rospy.set_param("/step", 0.25)

    def test_all_targets_are_reached_in_order():
        got = []
        gap = rospy.Publisher("/gap", Float64, queue_size=10)

        def move(message):
            got.append(message)
            gap.publish(1.0)
            gap.publish(0.001)

        rospy.Subscriber("/target", PointStamped, move)
        mission = subprocess.run([sys.executable, "mission.py"], timeout=20, check=False)
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

    [[operation]]
    parameter = "/step"
"""
#: what becomes of each, and what of its kill says why
WANTED = {
    "target.publish#1:call:drop=every-3rd": ("killed", "assert 1 == 0"),
    "target.publish#1:call:duplicate": ("killed", "[0.25, 0.25, "),
    "target.publish#1:call:stale=previous": ("killed", "[0.25, 0.25, 0.5, 0.75]"),
    "target.publish#1:call:delay=0.1": ("survived", ""),
    "target.publish#1:header.frame_id:wrong-frame": ("killed", "tool"),
    "target.publish#1:call:kill-node": ("killed", "assert -9 == 0"),
    "def on_gap#1:call:drop": ("killed", "assert 1 == 0"),
    "def on_gap#1:call:restart-node": ("killed", "[0.25, 0.25, 0.5, 0.75, 1.0]"),
    "rospy.get_param#1:value:use-default": ("killed", "[0.5, 1.0, 1.5, 2.0]"),
}


@needs_ros1
@pytest.mark.whole
def test_faults_of_the_middleware_act_in_the_node_and_the_suite_notices_those_it_checks(
    tmp_path: Path,
) -> None:
    more = {"conftest.py": MASTER}
    write_project(tmp_path, MISSION, TESTS, vocabulary=VOCABULARY, configuration=CONFIGURATION, more=more)
    check_faults_of_the_middleware(tmp_path, WANTED)
