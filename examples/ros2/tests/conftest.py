"""One simulated cell per test, drawn from the round's seed, in a process of its own."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest
import rclpy
import tracker
from processes import FOLDER, start, stop
from rclpy.node import Node

# nobody else's nodes: of other machines, or of other tests that run beside these
os.environ.setdefault("ROS_DOMAIN_ID", str(os.getpid() % 101 + 1))
if "FASTDDS_DEFAULT_PROFILES_FILE" not in os.environ:
    os.environ["FASTDDS_DEFAULT_PROFILES_FILE"] = str(FOLDER / "discovery.xml")
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "SYSTEM_DEFAULT"  # as the file says


@pytest.fixture
def cell(mutabot_seed: int) -> Iterator[Node]:
    """The published cell: robot at home, a red or blue box on the conveyor. Gives the test's own node."""
    process = start("cell.py", "--seed", str(mutabot_seed))
    try:
        rclpy.init()
        node = Node("test", enable_rosout=False, start_parameter_services=False)
        tracker.connect(node)
        yield node
        node.destroy_node()
    finally:
        rclpy.try_shutdown()
        stop(process)
