"""Nodes that roslaunch starts, and a test of rostest, are part of a campaign."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from shutil import which

import pytest

from mutabot.model import Verdict
from tests.campaign.project import run, write_project

pytestmark = pytest.mark.skipif(
    find_spec("rospy") is None or which("roslaunch") is None or which("rostest") is None,
    reason="no rospy: install Debian's python3-rospy, python3-roslaunch and python3-rostest",
)

FILES = {
    "package.xml": """\
        <package format="2">
          <name>cell</name><version>1.0.0</version><description>A gripper.</description>
          <maintainer email="nobody@example.com">nobody</maintainer><license>MIT</license>
        </package>
    """,
    "driver.py": """
        import rospy
        from std_srvs.srv import SetBool, SetBoolResponse

        def close(request):
            rospy.set_param("closed", request.data)
            return SetBoolResponse(True, "")

        rospy.init_node("driver")
        rospy.Service("gripper/close", SetBool, close)
        rospy.spin()
    """,
    # nodes are started by the interpreter that runs the tests, whatever env finds
    "cell.launch": """\
        <launch>
          <group ns="left">
            <node pkg="cell" type="driver.py" name="driver" launch-prefix="$(env NODE_PYTHON)"/>
            <node pkg="cell" type="mission.py" name="mission" launch-prefix="$(env NODE_PYTHON)">
              <remap from="grip" to="gripper/close"/>
            </node>
          </group>
        </launch>
    """,
    "cell.test": """\
        <launch>
          <include file="$(find cell)/cell.launch"/>
          <test test-name="cell" pkg="cell" type="check.py" launch-prefix="$(env NODE_PYTHON)"/>
        </launch>
    """,
    "check.py": """
        import time
        import unittest
        import rospy
        import rostest

        class Check(unittest.TestCase):
            def test_closed(self):
                rospy.init_node("check")
                end = time.monotonic() + 60
                while not rospy.has_param("/left/done") and time.monotonic() < end:
                    time.sleep(0.01)
                self.assertTrue(rospy.get_param("/left/closed"))

        rostest.rosrun("cell", "cell", Check)
    """,
}
MISSION = """
    import rospy
    from std_srvs.srv import SetBool

    def main():
        rospy.init_node("mission")
        grip = rospy.ServiceProxy("grip", SetBool)
        grip.wait_for_service(20)
        grip(True)
        rospy.set_param("done", True)
        rospy.spin()

    if __name__ == "__main__":
        main()
"""
TESTS = """
    import os
    import shutil
    import signal
    import subprocess
    import sys
    import time

    import rospy

    os.environ["NODE_PYTHON"] = sys.executable
    os.environ["ROS_PACKAGE_PATH"] = os.getcwd()

    def test_launched():
        command = [sys.executable, shutil.which("roslaunch"), "cell", "cell.launch"]
        launched = subprocess.Popen(command)
        try:
            end = time.monotonic() + 60
            while not rospy.has_param("/left/done"):
                assert launched.poll() is None and time.monotonic() < end
                time.sleep(0.01)
            assert rospy.get_param("/left/closed")
        finally:
            launched.send_signal(signal.SIGINT)
            launched.wait()

    def test_with_rostest():
        command = [sys.executable, shutil.which("rostest"), "cell", "cell.test"]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout
"""
VOCABULARY = """
    [[operation]]
    service = "/left/gripper/close"
    type = "std_srvs/SetBool"
    request.data = { kind = "opening", values = [false, true] }
"""


@pytest.mark.whole
def test_mutants_of_launched_nodes_end_as_they_must(tmp_path: Path) -> None:
    project = write_project(tmp_path, MISSION, TESTS, vocabulary=VOCABULARY, more=FILES)
    for script in ("driver.py", "mission.py", "check.py"):
        (project / script).chmod(0o755)  # roslaunch takes no other files for nodes
    found = run(project, rounds=1, baseline=1, skip=("*:skip",))
    assert {mutant.removeprefix("mission.py:main:grip#1:"): end.verdict for mutant, end in found.items()} == {
        "data:opposite": Verdict.KILLED,
        "call:repeat": Verdict.SURVIVED,
    }
