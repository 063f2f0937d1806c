"""What goes wrong around a node of ROS 1 while its mutants run is told as what it is, and is no kill."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest

from tests.campaign.project import write_project

from .both import (
    CONFIGURATION,
    MASTER,
    End,
    check_that_a_driver_that_does_not_come_up_kills_no_mutant,
    check_that_a_node_killed_from_outside_kills_no_mutant,
    end_with_driver,
    needs_ros1,
)

pytestmark = needs_ros1

MISSION = """
    import sys

    import rospy
    from std_msgs.msg import Float64

    rospy.init_node("mission", disable_rosout=True)
    target = rospy.Publisher("/target", Float64, queue_size=10)
    for _ in range(200):
        if target.get_num_connections():
            break
        rospy.sleep(0.01)
    else:
        sys.exit("no driver has subscribed")
    target.publish(0.5)
    sys.exit(0 if rospy.wait_for_message("/reached", Float64, 3.0).data == 0.5 else "not there")
"""
DRIVER = """
    import os
    import sys
    import time
    from pathlib import Path

    import rospy
    from std_msgs.msg import Float64

    starts = Path(os.environ["STARTS"])
    with starts.open("a") as file:
        file.write("x")
    if len(starts.read_text()) > int(os.environ["LIMIT"]):
        sys.exit("the arm has no power")
    rospy.init_node("driver", disable_rosout=True)
    reached = rospy.Publisher("/reached", Float64, queue_size=1, latch=True)

    def on_target(message):
        if message.data < 0 and "VICTIM" in os.environ:
            Path(os.environ["VICTIM"]).write_text(str(os.getpid()))
            time.sleep(10)
        reached.publish(message)

    rospy.Subscriber("/target", Float64, on_target)
    rospy.spin()
"""
TESTS = """
    import subprocess
    import sys

    import pytest

    @pytest.fixture
    def driver(master):
        process = subprocess.Popen([sys.executable, "driver.py"])
        yield process
        process.terminate()
        process.wait()

    def test_the_target_is_reached(driver):
        mission = subprocess.run([sys.executable, "mission.py"], timeout=20, check=False)
        assert mission.returncode == 0
"""
VOCABULARY = """
    [[operation]]
    topic = "/target"
    direction = "publish"
    type = "std_msgs/Float64"
    fields.data = { kind = "translation", axis = "x", unit = "m", mode = "by" }
"""


@pytest.fixture
def end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> End:
    """How the reversed target ends."""
    more = {"driver.py": DRIVER, "conftest.py": MASTER}
    write_project(tmp_path, MISSION, TESTS, vocabulary=VOCABULARY, configuration=CONFIGURATION, more=more)
    return partial(end_with_driver, tmp_path, monkeypatch, "*:data:reverse")


@pytest.mark.whole
def test_a_node_that_is_killed_from_outside_kills_no_mutant(end: End) -> None:
    check_that_a_node_killed_from_outside_kills_no_mutant(end)


@pytest.mark.whole
def test_a_driver_that_does_not_come_up_kills_no_mutant(end: End) -> None:
    check_that_a_driver_that_does_not_come_up_kills_no_mutant(end)
