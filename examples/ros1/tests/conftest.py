"""A ROS graph for the tests: a master for all of them, and new nodes for each."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
import xmlrpc.client
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PATIENCE = 30.0
"""How long a node may take to come up, s."""

try:
    import rospy
except ImportError:  # the tests say so and skip themselves
    rospy = None


@pytest.fixture(scope="session")
def graph(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A master and a node of our own: the master that is given, or else one that is started."""
    os.environ.setdefault("ROS_LOG_DIR", str(tmp_path_factory.mktemp("ros")))
    is_given = "ROS_MASTER_URI" in os.environ and answers(os.environ["ROS_MASTER_URI"])
    with contextlib.nullcontext() if is_given else master():
        rospy.init_node("mission_test", disable_signals=True, disable_rosout=True)
        yield
        if is_given:
            rospy.signal_shutdown("all tests are over")


@pytest.fixture
def cell(graph: None, mutabot_seed: int) -> Iterator[None]:
    """The driver and the colour sensor, with the published cell: robot at home, a red or blue box."""
    rospy.set_param("/arm/patience", 5.0)
    with nodes(("nodes/driver.py", str(mutabot_seed)), ("nodes/colour_sensor.py",)) as started:
        wait_for("/arm/home", started)
        yield


def wait_for(service: str, started: list[subprocess.Popen[bytes]]) -> None:
    """Wait until a service is there, unless one of the nodes ends instead."""
    end = time.monotonic() + PATIENCE
    while True:
        try:
            rospy.wait_for_service(service, 1.0)
        except rospy.ROSException:
            ended = [node.args for node in started if node.poll() is not None]
            assert not ended, f"did not come up: {ended}"
            assert time.monotonic() < end, f"nobody offers {service}"
        else:
            return


@contextlib.contextmanager
def nodes(*commands: tuple[str, ...]) -> Iterator[list[subprocess.Popen[bytes]]]:
    """Nodes in processes of their own, which end with the block."""
    started = [subprocess.Popen([sys.executable, *command], cwd=ROOT) for command in commands]
    try:
        yield started
    finally:
        for node in started:
            node.terminate()
        for node in started:
            try:
                node.wait(5.0)
            except subprocess.TimeoutExpired:
                node.kill()
                node.wait()


@contextlib.contextmanager
def master() -> Iterator[None]:
    """A master on a port that nobody uses, for this process and all that it starts."""
    port = 32000 + os.getpid() % 700  # none of those that Linux gives to connections
    os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{port}"
    os.environ["ROS_IP"] = "127.0.0.1"
    started = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL)
    try:
        while not answers(os.environ["ROS_MASTER_URI"]):
            assert started.poll() is None, "rosmaster has ended"
        yield
    finally:
        started.terminate()
        started.wait()


def answers(uri: str) -> bool:
    """Whether a master is there."""
    try:
        xmlrpc.client.ServerProxy(uri).getPid("/mission_test")
    except OSError:
        return False
    return True
