"""What goes wrong around a node of ROS 1 while its mutants run is told as what it is, and is no kill."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.model import Outcome, Verdict
from tests.campaign.outside import killer
from tests.campaign.project import run, write_project

pytestmark = pytest.mark.skipif(
    find_spec("rospy") is None or find_spec("rosmaster") is None,
    reason="no rospy: install Debian's python3-rospy and python3-rosmaster",
)

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
    def driver(graph):
        process = subprocess.Popen([sys.executable, "driver.py"])
        yield process
        process.terminate()
        process.wait()

    def test_the_target_is_reached(driver):
        mission = subprocess.run([sys.executable, "mission.py"], timeout=20, check=False)
        assert mission.returncode == 0
"""
GRAPH = """
    import os
    import socket
    import subprocess
    import sys
    import time

    import pytest

    @pytest.fixture(scope="session")
    def graph(tmp_path_factory):
        port = 32000 + os.getpid() % 700  # none that the system gives to connections
        os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{port}"
        os.environ["ROS_LOG_DIR"] = str(tmp_path_factory.mktemp("ros"))
        code = "import rosmaster; rosmaster.rosmaster_main()"
        master = subprocess.Popen([sys.executable, "-c", code, "--core", "-p", str(port)])
        while True:
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.01)
        yield
        master.kill()
        master.wait()
"""
VOCABULARY = """
    [[operation]]
    topic = "/target"
    direction = "publish"
    type = "std_msgs/Float64"
    fields.data = { kind = "translation", axis = "x", unit = "m", mode = "by" }
"""
CONFIGURATION = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=.", "-W", "default"]
"""
REVERSE = "*:data:reverse"


def end_of(folder: Path, monkeypatch: pytest.MonkeyPatch, limit: int) -> Outcome:
    project = write_project(folder, MISSION, TESTS, vocabulary=VOCABULARY, configuration=CONFIGURATION)
    (project / "driver.py").write_text(dedent(DRIVER))
    (project / "conftest.py").write_text(dedent(GRAPH))
    starts = Path(f"/var/tmp/mutabot-{folder.name}-{id(folder)}")  # a place that no run keeps to itself
    monkeypatch.setenv("STARTS", str(starts))
    monkeypatch.setenv("LIMIT", str(limit))
    try:
        (found,) = run(project, only=(REVERSE,), rounds=1, jobs=1, fresh=True).values()
    finally:
        starts.unlink(missing_ok=True)
    return found


@pytest.mark.whole
def test_a_node_that_is_killed_from_outside_kills_no_mutant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with killer():
        found = end_of(tmp_path, monkeypatch, limit=1000)
    assert (found.verdict, found.acted) == (Verdict.ERROR, 1)
    assert found.message == "the process /driver was killed from outside, by signal 9"


@pytest.mark.whole
def test_a_driver_that_does_not_come_up_kills_no_mutant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # it comes up in the two runs of the baseline and in those of the two controls
    found = end_of(tmp_path, monkeypatch, limit=4)
    assert (found.verdict, found.acted) == (Verdict.UNSTABLE, 0)
    assert (found.message or "").startswith("failed before the mutant changed anything")
