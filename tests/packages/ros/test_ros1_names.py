"""A campaign on nodes of ROS 1 that a vocabulary describes by names alone, each a process of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.model import Role, Verdict
from tests.campaign.project import Quiet, request_for, write_project

from .both import needs_ros1

DRIVER = '''
    """Goes where it is told, tells where it is, and refuses by data."""

    import rospy
    from std_msgs.msg import Float64, Int32
    from std_srvs.srv import SetBool

    def go(message):
        note.publish(5 if message.data < 0.4 else 0)
        if message.data >= 0.4:
            pose.publish(message.data)

    def close(request):
        return request.data, "" if request.data else "there is nothing to open"

    rospy.init_node("driver")
    rospy.set_param("/mission/step", 0.25)
    note = rospy.Publisher("/arm/note", Int32, queue_size=10)
    pose = rospy.Publisher("/arm/pose", Float64, queue_size=10, latch=True)
    pose.publish(0.5)
    rospy.Service("/gripper/close", SetBool, close)
    rospy.Subscriber("/arm/goal", Float64, go)
    rospy.spin()
'''
MISSION = '''
    """Moves by a step from where the arm is; its topic is remapped by whoever starts it."""

    import rospy
    from std_msgs.msg import Float64, Int32
    from std_srvs.srv import SetBool

    poses, notes = [], []

    def on_pose(message):
        poses.append(message.data)

    def main():
        rospy.init_node("mission")
        rospy.Subscriber("/arm/pose", Float64, on_pose)
        rospy.Subscriber("/arm/note", Int32, lambda message: notes.append(message.data))
        goals = rospy.Publisher("goal", Float64, queue_size=1)
        rospy.wait_for_service("/gripper/close")
        while not poses or not goals.get_num_connections():
            rospy.sleep(0.01)
        goals.publish(poses[-1] + rospy.get_param("~step"))
        while not notes:
            rospy.sleep(0.01)
        if notes[0]:
            raise RuntimeError("refused")
        if not rospy.ServiceProxy("/gripper/close", SetBool)(True).success:
            raise RuntimeError("not closed")

    main()
'''
CHECKER = """
    import rospy
    from std_msgs.msg import Float64

    rospy.init_node("checker")
    print(rospy.wait_for_message("/arm/pose", Float64, timeout=60).data)
"""
TESTS = """
    import subprocess
    import sys

    def test_the_arm_moves_by_a_step_and_the_gripper_closes():
        driver = subprocess.Popen([sys.executable, "robot.py"])
        try:
            subprocess.run([sys.executable, "mission.py", "goal:=/arm/goal"], timeout=120, check=True)
            checker = [sys.executable, "checker.py"]
            done = subprocess.run(checker, timeout=120, check=True, stdout=subprocess.PIPE)
            assert float(done.stdout) >= 0.7
        finally:
            driver.kill()
            driver.wait()
"""
VOCABULARY = """
    [[operation]]
    topic = "/arm/goal"
    direction = "publish"
    node = "/miss*"
    fields.data = { kind = "translation", axis = "x", unit = "m", mode = "to", relative = true }
    current = "receive /arm/pose"
    refused = { topic = "/arm/note", path = "data", values = [5] }

    [[operation]]
    topic = "/arm/pose"
    direction = "receive"
    fields.data = { kind = "position", axis = "x", unit = "m" }

    [[operation]]
    service = "/gripper/close"
    request.data = { kind = "output", values = [false, true] }
    refused = { path = "success", values = [false] }

    [[operation]]
    parameter = "/mission/step"
    value = { kind = "distance", unit = "m" }

    [[operation]]
    service = "/griper/open"
"""
CONFIGURATION = """
    program = ["mission.py", "checker.py"]
    oracle_nodes = ["/checker"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=.", "-W", "default"]
"""


@needs_ros1
@pytest.mark.whole
def test_a_vocabulary_of_names_is_enough_for_nodes_in_processes_of_their_own(tmp_path: Path) -> None:
    write_project(
        tmp_path,
        MISSION,
        TESTS,
        robot=DRIVER,
        vocabulary=VOCABULARY,
        configuration=CONFIGURATION,
        more={"checker.py": CHECKER},
    )
    quiet = Quiet()
    request = request_for(tmp_path, only=["reverse", "opposite", "negate"])
    with Journal.open(run_campaign(request, quiet)) as journal:
        mutants = {mutant.id.partition(":")[2]: mutant for mutant in journal.mutants()}
        found = {outcome.mutant: outcome for outcome in journal.outcomes()}
    told = {name: (found[mutant.id].verdict, found[mutant.id].message) for name, mutant in mutants.items()}
    # 2 · 0.5 − 0.75 is refused by a message, closing by an answer; none of the two is a kill
    assert told["main:goals.publish#1:data:reverse"] == (Verdict.REFUSED, "/arm/note: data 5")
    gripper = 'main:rospy.ServiceProxy("/gripper/close", SetBool)#1:data:opposite'
    assert told[gripper] == (Verdict.REFUSED, "answered success False")
    # what tests read, and a pose read with the wrong sign, from which a refused goal is computed
    assert told["<module>:rospy.wait_for_message#1:data:negate"][0] is Verdict.KILLED
    assert told["on_pose:def on_pose#1:data:negate"][0] is Verdict.KILLED
    assert {mutant.site.role for mutant in mutants.values() if mutant.site.span.file == "checker.py"} == {
        Role.ORACLE
    }
    assert mutants["main:goals.publish#1:data:reverse"].description == (
        "publish /arm/goal of /miss*: data (x) 0.75 m → as far to the other side of where it is"
    )
    unused = "no test called the service /griper/open; seen: call /gripper/close"
    assert any(unused in line for line in quiet.lines)
