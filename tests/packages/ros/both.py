"""What tests of ROS 1 and of ROS 2 have in common."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import Outcome, Verdict
from tests.campaign.outside import killer
from tests.campaign.project import Quiet, outcomes, request_for, run
from tests.runtime.stage import Stage

needs_ros1 = pytest.mark.skipif(
    find_spec("rospy") is None or find_spec("rosmaster") is None,
    reason="no rospy: install Debian's python3-rospy and python3-rosmaster",
)
needs_ros2 = pytest.mark.skipif(
    find_spec("rclpy") is None, reason="no ROS 2: pip install -r requirements-ros2.lock"
)
ROOT = Path(__file__).parents[3]
CONFIGURATION = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=.", "-W", "default"]
"""

# --- of one node that also hears and answers itself ---

GOAL = """
    [[operation]]
    topic = "/cell/goal"
    direction = "publish"
    type = "geometry_msgs/Twist"
    fields."linear.y" = { kind = "translation", axis = "y", unit = "m", mode = "by" }
"""
CLOSE = """
    [[operation]]
    service = "/cell/gripper/close"
    type = "std_srvs/SetBool"
    request.data = { kind = "opening", values = [false, true] }
    response.success = { kind = "flag" }
"""
LEVEL = """
    [[operation]]
    topic = "/line/level"
    direction = "receive"
    fields.data = { kind = "distance", unit = "m" }
"""
#: makes a stage of a program over ROS and a vocabulary
Making = Callable[[str, str], Stage]


def places(stage: Stage) -> set[tuple[str, str]]:
    """What was seen, with the text of its lines."""
    lines = (stage.folder / f"{stage.program_name}.py").read_text(encoding="utf-8").splitlines()
    return {(seen.operation, lines[seen.span.line - 1].strip()) for seen in stage.sites()}


#: seconds after which a process that hangs is ended; what runs takes a tenth, if nothing else does
_HANGS = 900.0


def run_cases(file: str, environment: Mapping[str, str]) -> None:
    """Run a file of cases in a process of its own: the client libraries leave threads and nodes in theirs."""
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "default",
         f"tests/packages/ros/{file}"],
        cwd=ROOT,
        env={**os.environ, **environment, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True, text=True, timeout=_HANGS, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


# --- of a node that is a process of its own ---

#: for a conftest: a master of ROS 1 for the tests of a project
MASTER = """
    import os
    import socket
    import subprocess
    import sys
    import time

    import pytest

    @pytest.fixture(scope="session")
    def master(tmp_path_factory):
        port = 32000 + os.getpid() % 700  # none that the system gives to connections
        os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{port}"
        os.environ["ROS_LOG_DIR"] = str(tmp_path_factory.mktemp("ros"))
        code = "import rosmaster; rosmaster.rosmaster_main()"
        process = subprocess.Popen([sys.executable, "-c", code, "--core", "-p", str(port)])
        while True:
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.01)
        yield
        process.kill()
        process.wait()
"""


def check_faults_of_the_middleware(
    project: Path, wanted: Mapping[str, tuple[str, str]], **changes: Any
) -> None:
    """Each of these mutants acts in the node and ends so.

    Args:
        project: whose suite checks its node.
        wanted: verdict by the end of the mutant's id, and what of its kill says why.
        changes: of the request.
    """
    only = tuple(f"*:{name}" for name in wanted)
    found = run(project, families=("middleware",), only=only, rounds=1, **changes)
    ends = {name.split(":", 2)[2]: value for name, value in found.items()}
    assert {name: str(end.verdict) for name, end in ends.items()} == {
        name: verdict for name, (verdict, _) in wanted.items()
    }
    for name, outcome in ends.items():
        assert outcome.acted, name
        assert wanted[name][1] in (outcome.message or ""), name


#: how a mutant ends whose driver comes up at most so many times, and what the campaign told
End = Callable[[int], tuple[Outcome, list[str]]]


def end_with_driver(
    project: Path, monkeypatch: pytest.MonkeyPatch, mutant: str, limit: int, **changes: Any
) -> tuple[Outcome, list[str]]:
    """How a mutant ends, and what the campaign told.

    The project's driver notes each of its starts in the file STARTS, and comes up at most LIMIT times.
    """
    starts = Path(f"/var/tmp/mutabot-{project.name}-{id(project)}")  # a place that no run keeps to itself
    monkeypatch.setenv("STARTS", str(starts))
    monkeypatch.setenv("LIMIT", str(limit))
    progress = Quiet()
    try:
        request = request_for(project, only=(mutant,), rounds=1, jobs=1, fresh=True, **changes)
        (found,) = outcomes(run_campaign(request, progress))
    finally:
        starts.unlink(missing_ok=True)
    return found, progress.lines


def check_that_a_node_killed_from_outside_kills_no_mutant(end: End) -> None:
    """The driver is killed when it hears of what the mutant does."""
    with killer():
        found, _ = end(1000)
    assert (found.verdict, found.acted) == (Verdict.ERROR, 1)
    assert found.message == "the process /driver was killed from outside, by signal 9"


def check_that_a_driver_that_does_not_come_up_kills_no_mutant(end: End) -> None:
    """It comes up in the two runs of the baseline and in those of the two controls."""
    found, _ = end(4)
    assert (found.verdict, found.acted) == (Verdict.UNSTABLE, 0)
    assert (found.message or "").startswith("failed before the mutant changed anything")
