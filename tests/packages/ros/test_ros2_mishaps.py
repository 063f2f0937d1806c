"""What goes wrong around a node of ROS 2 while its mutants run is told as what it is, and is no kill."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import Outcome, Verdict
from tests.campaign.outside import killer
from tests.campaign.project import Quiet, outcomes, request_for, write_project

pytest.importorskip("rclpy", reason="no ROS 2 in this environment (requirements-ros2.lock)")

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
CONFIGURATION = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=.", "-W", "default"]
"""
#: the target that counts, in the direction that is looked at, and in one that nobody looks at
LOOKED_AT, IGNORED = "*target.publish#2:x:reverse", "*target.publish#2:y:reverse"


def end_of(
    folder: Path, monkeypatch: pytest.MonkeyPatch, mutant: str, limit: int = 1000, drivers: int = 1
) -> tuple[Outcome, list[str]]:
    """How the mutant ends, and what the campaign told."""
    tests = TESTS.format(drivers=drivers)
    project = write_project(folder, MISSION, tests, vocabulary=VOCABULARY, configuration=CONFIGURATION)
    (project / "driver.py").write_text(dedent(DRIVER))
    starts = Path(f"/var/tmp/mutabot-{folder.name}-{id(folder)}")  # a place that no run keeps to itself
    monkeypatch.setenv("STARTS", str(starts))
    monkeypatch.setenv("LIMIT", str(limit))
    progress = Quiet()
    try:
        request = request_for(project, only=(mutant,), rounds=1, jobs=1, fresh=True, engine="replay")
        (found,) = outcomes(run_campaign(request, progress))
    finally:
        starts.unlink(missing_ok=True)
    return found, progress.lines


@pytest.mark.whole
def test_a_node_that_is_killed_from_outside_kills_no_mutant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with killer():
        found, _ = end_of(tmp_path, monkeypatch, LOOKED_AT)
    assert (found.verdict, found.acted) == (Verdict.ERROR, 1)
    assert found.message == "the process /driver was killed from outside, by signal 9"


@pytest.mark.whole
def test_a_driver_that_does_not_come_up_kills_no_mutant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # it comes up in the two runs of the baseline and in those of the two controls
    found, _ = end_of(tmp_path, monkeypatch, LOOKED_AT, limit=4)
    assert (found.verdict, found.acted) == (Verdict.UNSTABLE, 0)
    assert (found.message or "").startswith("failed before the mutant changed anything")


def test_a_full_queue_kills_no_mutant_and_a_topic_without_messages_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, lines = end_of(tmp_path, monkeypatch, IGNORED)
    assert (found.verdict, found.acted) == (Verdict.SURVIVED, 1)
    assert any("no test received anything on /nothing" in line for line in lines)


@pytest.mark.whole
def test_with_two_nodes_of_one_name_the_tests_judge_as_ever(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, _ = end_of(tmp_path, monkeypatch, IGNORED, drivers=2)
    assert (found.verdict, found.acted) == (Verdict.SURVIVED, 1)
